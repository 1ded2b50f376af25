"""Molecule files in JSON format, as the lines of the native format that say the same.

Source: the LAMMPS manual page of ``molecule``.
"""
from __future__ import annotations

import json
from typing import Any

from asemd.errors import InputError, Where, nearest

HEADER = ("application", "format", "revision", "title", "schema", "units", "masstotal", "com", "inertia")
# section -> heading in the native format, names of its columns
SECTIONS = {
    "types": ("Types", ("atom-id", "type")),
    "coords": ("Coords", ("atom-id", "x", "y", "z")),
    "molecules": ("Molecules", ("atom-id", "molecule-id")),
    "fragments": ("Fragments", ("fragment-id", "atom-id-list")),
    "charges": ("Charges", ("atom-id", "charge")),
    "diameters": ("Diameters", ("atom-id", "diameter")),
    "dipoles": ("Dipoles", ("atom-id", "mux", "muy", "muz")),
    "masses": ("Masses", ("atom-id", "mass")),
    "bonds": ("Bonds", ("bond-type", "atom1", "atom2")),
    "angles": ("Angles", ("angle-type", "atom1", "atom2", "atom3")),
    "dihedrals": ("Dihedrals", ("dihedral-type", "atom1", "atom2", "atom3", "atom4")),
    "impropers": ("Impropers", ("improper-type", "atom1", "atom2", "atom3", "atom4")),
}
PARTS = {
    "special": {"counts": ("Special Bond Counts", ("atom-id", "n12", "n13", "n14")),
                "bonds": ("Special Bonds", ("atom-id", "atom-id-list"))},
    "shake": {"flags": ("Shake Flags", ("atom-id", "flag")), "atoms": ("Shake Atoms", ("atom-id", "atom-id-list")),
              "types": ("Shake Bond Types", ("atom-id", "type-list"))},
}
KNOWN = (*HEADER, *SECTIONS, *PARTS, "body")


class Native:
    """A file as lines of the native format.

    Attributes
    ----------
    words : list of list of str
        The words of each line.
    lines : list of str
        What to show of each line: the entry of the JSON file.
    numbers : list of int
        Line of the JSON file on which the section begins.
    """

    def __init__(self, path: str, text: str, system):
        self.path, self.text, self.system = path, text, system
        self.data = self._parse()
        self.words: list[list[str]] = []
        self.lines: list[str] = []
        self.numbers: list[int] = []
        self._check_header()
        self._add([], str(self.data.get("title", "")), 1)       # the first line is the title
        present = [key for key in SECTIONS if key in self.data]
        for key in present:
            if key not in ("coords", "charges", "molecules", "diameters", "dipoles", "masses"):
                count = len(self._rows(key, self.data[key]))
                self._add([str(count), "atoms" if key == "types" else key], f"{count} {key}", self._line(key))
        for key, name, length in (("masstotal", "mass", 1), ("com", "com", 3), ("inertia", "inertia", 6)):
            if key in self.data:
                values = self.data[key] if isinstance(self.data[key], list) else [self.data[key]]
                if len(values) != length:
                    raise self._fail(f'"{key}" needs {length} numbers', key)
                self._add([*(self._word(v, key) for v in values), name], json.dumps(self.data[key]), self._line(key))
        for key in present:
            self._section(key, self.data[key], *SECTIONS[key])
        for key, parts in PARTS.items():
            if key in self.data:
                for part, (heading, columns) in parts.items():
                    if not isinstance(self.data[key], dict) or part not in self.data[key]:
                        raise self._fail(f'"{key}" has no "{part}"', key)
                    self._section(f"{key}:{part}", self.data[key][part], heading, columns)

    def _parse(self) -> dict[str, Any]:
        def constant(word: str):
            raise ValueError(f"{word} is not a number in JSON")
        try:
            data = json.loads(self.text, parse_constant=constant)
        except ValueError as e:
            line = getattr(e, "lineno", 1)
            raise InputError(f"molecule: not valid JSON: {e}", Where(self.path, line, self.text.split("\n")[line - 1])) from None
        except RecursionError:
            raise InputError(f"molecule: {self.path}: the JSON data is nested too deeply") from None
        if not isinstance(data, dict):
            raise InputError(f"molecule: {self.path}: the JSON data must be an object with the sections of the molecule")
        return data

    def _check_header(self) -> None:
        for key in self.data:
            if key not in KNOWN:
                raise self._fail(f'unknown section "{key}"{nearest(key, KNOWN)}', key)
        for key, wanted in (("application", "LAMMPS"), ("format", "molecule"), ("revision", 1)):
            if self.data.get(key) != wanted:
                raise self._fail(f'needs "{key}": {json.dumps(wanted)}, got {json.dumps(self.data.get(key))}', key)
        if self.data.get("units", self.system.units) != self.system.units:
            raise self._fail(f'the file has units {self.data["units"]}, the scene {self.system.units}', "units")
        if "types" not in self.data:
            raise InputError(f'molecule: {self.path}: the section "types" is missing')
        if "body" in self.data:
            raise self._fail("bodies are not supported", "body")

    # ---- places and words
    def _line(self, key: str) -> int:
        """The line on which a section begins."""
        return self.text[:max(0, self.text.find(f'"{key.split(":")[0]}"'))].count("\n") + 1

    def _fail(self, message: str, key: str, entry: Any = None) -> InputError:
        line = self._line(key)
        text = json.dumps(entry) if entry is not None else self.text.split("\n")[line - 1]
        return InputError(f"molecule: {message}", Where(self.path, line, text[:120]))

    def _add(self, words: list[str], text: str, number: int) -> None:
        self.words.append(words)
        self.lines.append(text)
        self.numbers.append(number)

    def _word(self, value: Any, key: str) -> str:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self._fail(f'section "{key}": expected a number, got {json.dumps(value)}', key)
        return repr(value)

    def _type(self, value: Any, kind: str, key: str) -> str:
        """A number or a type label; text that looks like a number is a label too."""
        if not isinstance(value, str):
            return self._word(value, key)
        labels = self.system.labels[kind]
        if value not in labels.values():
            raise self._fail(f'section "{key}": unknown {kind} type {value!r}{nearest(value, labels.values())}', key)
        return value

    # ---- sections
    def _rows(self, key: str, section: Any) -> list:
        if not isinstance(section, dict) or not isinstance(section.get("format"), list) or not isinstance(section.get("data"), list):
            raise self._fail(f'section "{key}" needs lists "format" and "data"', key)
        if not section["data"]:
            raise self._fail(f'section "{key}" has no data', key)
        return section["data"]

    def _section(self, key: str, section: Any, heading: str, columns: tuple[str, ...]) -> None:
        rows, bonded = self._rows(key, section), columns[0].endswith("-type")
        if (len(section["format"]) != len(columns)) if bonded else tuple(section["format"]) != columns:
            raise self._fail(f'section "{key}" needs "format": {json.dumps(columns)}, got {json.dumps(section["format"])}', key)
        atoms = len(self.data["types"]["data"])
        if not bonded and key != "fragments" and len(rows) != atoms:
            raise self._fail(f'section "{key}" has {len(rows)} entries for {atoms} atoms', key)
        start = self._line(key)
        self._add([], "", start)
        self._add(heading.split(), heading, start)
        self._add([], "", start)
        for number, row in enumerate(rows, 1):
            if not isinstance(row, list) or len(row) != len(columns):
                raise self._fail(f'section "{key}": an entry must be a list of {len(columns)} values', key, row)
            self._add(self._entry(key, row, columns, number), json.dumps(row), start)

    def _entry(self, key: str, row: list, columns: tuple[str, ...], number: int) -> list[str]:
        """The words of one entry."""
        words: list[str] = []
        for name, value in zip(columns, row):
            if name.endswith("-list"):
                values = value if isinstance(value, list) else [value]
                if name == "type-list":     # the third type of a flag 1 is that of the angle
                    kinds = ["bond"] * len(values) if len(values) != 3 or self._flag(row[0]) != 1 else ["bond", "bond", "angle"]
                    words += [self._type(v, kind, key) for v, kind in zip(values, kinds)]
                else:
                    words += [self._word(v, key) for v in values]
            elif name == "type":
                words.append(self._type(value, "atom", key))
            elif name.endswith("-type"):
                words.append(self._type(value, name.removesuffix("-type"), key))
            else:
                words.append(str(value) if name == "fragment-id" else self._word(value, key))
        return [str(number), *words] if columns[0].endswith("-type") else words

    def _flag(self, atom: Any) -> int:
        return dict(self.data["shake"]["flags"]["data"]).get(atom, 0)
