"""Molecule files of the command ``molecule``: the native format; JSON is read by way of it.

Source: the LAMMPS manual page of ``molecule``.
"""
from __future__ import annotations

import os
from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError, Where, nearest
from asemd.lammps.molecule_json import Native
from asemd.molecule import Molecule
from asemd.system import LABELLED
from asemd.topology import ATOMS, Topology
from asemd.words import bounds, number, whole

HEADER = {"atoms": 1, "bonds": 1, "angles": 1, "dihedrals": 1, "impropers": 1, "fragments": 1, "mass": 1, "com": 3, "inertia": 6}
# section -> numbers of each atom
PER_ATOM = {"Coords": 3, "Types": 1, "Molecules": 1, "Charges": 1, "Diameters": 1, "Dipoles": 3, "Masses": 1}
ITEMS = {"Bonds": "bond", "Angles": "angle", "Dihedrals": "dihedral", "Impropers": "improper"}
OTHER = ("Fragments", "Special Bond Counts", "Special Bonds", "Shake Flags", "Shake Atoms", "Shake Bond Types")
BODY = ("Body Integers", "Body Doubles")
SECTIONS = (*PER_ATOM, *ITEMS, *OTHER, *BODY)


@dataclass
class Offsets:
    """What is added to the types of a file, and the factor of its lengths, masses and the like."""

    of: dict[str, int] = field(default_factory=lambda: dict.fromkeys(LABELLED, 0))
    scale: float = 1.0


def read(path: str, system, offsets: Offsets) -> Molecule:
    """Read one molecule.

    Parameters
    ----------
    path : str
    system : asemd.system.System
        Its numbers of types bound those of the file, and type labels are its own.
    offsets : Offsets

    Raises
    ------
    InputError
        Anything wrong in the file, with its place.
    """
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as f:
            text = f.read()
    except OSError as e:
        raise InputError(f"molecule: cannot open molecule file {path}: {e.strerror}") from None
    if os.fspath(path).endswith(".json"):
        return from_json(path, text, system, offsets)
    return Reader(path, text.split("\n"), system, offsets).molecule


def from_json(path: str, text: str, system, offsets: Offsets) -> Molecule:
    """The molecule of a JSON text; `path` names it in messages."""
    native = Native(path, text, system)
    return Reader(path, native.lines, system, offsets, native.words, native.numbers).molecule


class Reader:
    """Reads the lines of one file into `molecule`."""

    def __init__(self, path: str, lines: list[str], system, offsets: Offsets, words: list[list[str]] | None = None,
                 numbers: list[int] | None = None):
        self.path, self.lines, self.system, self.offsets = path, lines, system, offsets
        self.words = words or [line.split("#", 1)[0].split() for line in lines]
        self.numbers = numbers or range(1, len(lines) + 1)      # of the lines in the file
        self.header: dict[str, list[float]] = {}
        self.at = 1
        self.molecule = Molecule(title=lines[0].strip())
        self._read_header()
        self.items: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self.special: dict[str, list[list[int]]] = {}
        seen: set[str] = set()
        while (line := self._next()) is not None:
            name = " ".join(self.words[line])
            if name not in SECTIONS:
                raise self._fail(f"unknown section {name!r}{nearest(name, SECTIONS)}", line)
            if name in BODY:
                raise self._fail(f"section {name} belongs to atom_style body, which is not supported", line)
            if name in seen:
                raise self._fail(f"section {name} appears twice", line)
            seen.add(name)
            self._section(name, line)
        for title, kind in ITEMS.items():
            if self.count(f"{kind}s") and title not in seen:
                raise self._fail(f"the header promises {kind}s, but there is no section {title}")
        self.molecule.topology = Topology(**{f"{k}s": a for k, (a, _) in self.items.items()},
                                          **{f"{k}_types": t for k, (_, t) in self.items.items()})
        self._check_special()

    # ---- lines
    def _fail(self, message: str, line: int | None = None) -> InputError:
        place = None if line is None else self._where(line)
        return InputError(f"molecule: {message}" + ("" if place else f" ({self.path})"), place)

    def _where(self, line: int) -> Where:
        return Where(self.path, self.numbers[line], self.lines[line])

    def _next(self) -> int | None:
        """The next line that has words."""
        while self.at < len(self.lines):
            self.at += 1
            if self.words[self.at - 1]:
                return self.at - 1
        return None

    def count(self, name: str) -> int:
        return int(self.header.get(name, [0])[0])

    def _number(self, word: str, line: int) -> float:
        try:
            return number(word, "molecule")
        except InputError as e:
            raise e.at(self._where(line)) from None

    def _whole(self, word: str, line: int, low: int, high: int, name: str) -> int:
        try:
            value = whole(word, f"molecule: {name}")
        except InputError as e:
            raise e.at(self._where(line)) from None
        if not low <= value <= high:
            raise self._fail(f"{name} {value} is outside the valid range {low} to {high}", line)
        return value

    def _type(self, word: str, kind: str, line: int) -> int:
        """A type: labels stay as they are, numbers are raised by the offset."""
        count, labels = self.system.counts["ntypes" if kind == "atom" else f"n{kind}types"], self.system.labels[kind]
        if word in labels.values():
            return bounds(word, 1, count, "molecule", labels)[0]
        if not word.lstrip("+-").isdigit():
            raise self._fail(f"unknown {kind} type {word!r}{nearest(word, labels.values())}", line)
        return self._whole(str(int(word) + self.offsets.of[kind]), line, 1, count, f"{kind} type")

    # ---- header
    def _read_header(self) -> None:
        while (line := self._next()) is not None:
            words = self.words[line]
            if words[0][0].isalpha():
                self.at = line
                break
            name = words[-1]
            if name == "body":
                raise self._fail("bodies are not supported", line)
            if name not in HEADER or len(words) - 1 != HEADER[name]:
                raise self._fail(f"unknown or incomplete header line {' '.join(words)!r}{nearest(name, HEADER)}", line)
            self.header[name] = [self._number(w, line) for w in words[:-1]]
            if name.endswith("s") and name != "mass":
                self._whole(words[0], line, 0, 2**31 - 1, f"the number of {name}")
        n, m, s = self.count("atoms"), self.molecule, self.offsets.scale
        if n < 1:
            raise self._fail("the header gives no number of atoms")
        m.natoms = n
        if "mass" in self.header:
            m.mass = self.header["mass"][0] * s**3
            if m.mass <= 0.0:
                raise self._fail("the mass must be positive")
        if "com" in self.header:
            m.com = np.array(self.header["com"]) * s
        if "inertia" in self.header:
            m.inertia = np.array(self.header["inertia"]) * s**5

    # ---- sections
    def _section(self, name: str, heading: int) -> None:
        if name in PER_ATOM:
            self._set(name, np.array(self._rows(name, PER_ATOM[name])))
        elif name in ITEMS:
            self._items(name, heading)
        elif name == "Fragments":
            self._fragments(heading)
        elif name == "Shake Flags":
            self.molecule.shake["flag"] = [row[0] for row in self._whole_rows(name, 1)]
            if any(not 0 <= f <= 4 for f in self.molecule.shake["flag"]):
                raise self._fail("a SHAKE flag must be from 0 to 4", heading)
        elif name == "Special Bond Counts":
            self.special["counts"] = self._whole_rows(name, 3)
        else:
            self._lists(name, heading)

    def _rows(self, name: str, width: int) -> list[list[float]]:
        """The values of a section with one line for each atom, in order of atoms."""
        out: list = [None] * self.molecule.natoms
        for line, row, words in self._atom_lines(name):
            if len(words) != width:
                raise self._fail(f"section {name} needs {width + 1} words in each line", line)
            out[row] = [self._type(words[0], "atom", line)] if name == "Types" else [self._number(w, line) for w in words]
        return out

    def _atom_lines(self, name: str):
        """(line, row, words behind the atom) for each atom."""
        n, seen = self.molecule.natoms, set()
        for _ in range(n):
            line = self._next()
            if line is None or (self.words[line][0][0].isalpha() and " ".join(self.words[line]) in SECTIONS):
                raise self._fail(f"section {name} has fewer lines than the {n} atoms", line)
            row = self._whole(self.words[line][0], line, 1, n, "atom") - 1
            if row in seen:
                raise self._fail(f"section {name} has atom {row + 1} twice", line)
            seen.add(row)
            yield line, row, self.words[line][1:]

    def _whole_rows(self, name: str, width: int) -> list[list[int]]:
        return [[int(v) for v in row] for row in self._rows(name, width)]

    def _set(self, name: str, values: np.ndarray) -> None:
        m, s = self.molecule, self.offsets.scale
        column = values[:, 0]
        if name == "Coords":
            m.x = values * s
            if self.system.dimension == 2 and m.x[:, 2].any():
                raise self._fail("in a 2d simulation all z coordinates of section Coords must be 0")
        elif name == "Types":
            m.type = column.astype(np.int32)
        elif name == "Molecules":
            m.molecule = column.astype(np.int64)
            if m.molecule.min() < 1 or m.molecule.max() > m.natoms:
                raise self._fail("section Molecules must number molecules from 1")
        elif name == "Charges":
            m.q = column
        elif name == "Diameters":
            m.radius = 0.5 * column * s
            if m.radius.min() < 0.0:
                raise self._fail("section Diameters has a negative diameter")
        elif name == "Dipoles":
            m.mu = values * s
        else:
            m.rmass = column * s**3
            if m.rmass.min() <= 0.0:
                raise self._fail("section Masses has a mass that is not positive")

    def _items(self, name: str, heading: int) -> None:
        kind = ITEMS[name]
        atoms, types, n = [], [], self.molecule.natoms
        if not self.count(f"{kind}s"):
            raise self._fail(f"section {name}, but the header has no number of {kind}s", heading)
        for _ in range(self.count(f"{kind}s")):
            line = self._next()
            if line is None or len(self.words[line]) != 2 + ATOMS[kind]:
                raise self._fail(f"section {name} needs lines of number, type and {ATOMS[kind]} atoms for each of its "
                                 f"{self.count(f'{kind}s')} {kind}s", line)
            words = self.words[line]
            types.append(self._type(words[1], kind, line))
            atoms.append([self._whole(w, line, 1, n, "atom") - 1 for w in words[2:]])
            if len(set(atoms[-1])) < ATOMS[kind]:
                raise self._fail(f"a {kind} has one atom twice", line)
        self.items[kind] = np.array(atoms), np.array(types)

    def _fragments(self, heading: int) -> None:
        for _ in range(self.count("fragments")):
            line = self._next()
            if line is None or len(self.words[line]) < 2:
                raise self._fail("section Fragments needs a name and atoms for each fragment", line if line is not None else heading)
            mask = np.zeros(self.molecule.natoms, bool)
            for word in self.words[line][1:]:
                mask[self._whole(word, line, 1, self.molecule.natoms, "atom") - 1] = True
            self.molecule.fragments[self.words[line][0]] = mask

    def _lists(self, name: str, heading: int) -> None:
        """Sections whose lines are as long as an earlier section says."""
        m, shake = self.molecule, self.molecule.shake
        before = "Special Bond Counts" if name == "Special Bonds" else "Shake Flags"
        if ("counts" not in self.special) if name == "Special Bonds" else ("flag" not in shake):
            raise self._fail(f"section {name} must come after section {before}", heading)
        out: list[list[int]] = [[] for _ in range(m.natoms)]
        for line, row, words in self._atom_lines(name):
            if name == "Special Bonds":
                need = sum(self.special["counts"][row])
            else:
                flag = shake["flag"][row]
                need = {0: 0, 1: 3, 2: 2, 3: 3, 4: 4}[flag] - (name == "Shake Bond Types" and flag > 1)
            if len(words) != need:
                raise self._fail(f"section {name}: atom {row + 1} needs {need} values, got {len(words)}", line)
            if name == "Shake Bond Types":
                kinds = ["bond"] * len(words)
                if shake["flag"][row] == 1:
                    kinds[-1] = "angle"
                out[row] = [self._type(w, kind, line) for w, kind in zip(words, kinds)]
            else:
                out[row] = [self._whole(w, line, 1, m.natoms, "atom") - 1 for w in words]
        if name == "Special Bonds":
            self.special["lists"] = out
        else:
            shake["atoms" if name == "Shake Atoms" else "types"] = out

    def _check_special(self) -> None:
        """Neighbours through bonds follow from the bonds; a file that says otherwise is refused."""
        if "lists" not in self.special:
            return
        given = set()
        for row, (counts, atoms) in enumerate(zip(self.special["counts"], self.special["lists"])):
            kinds = [k for k, c in enumerate(counts, 1) for _ in range(c)]
            given |= {(min(row, a), max(row, a), k) for a, k in zip(atoms, kinds)}
        pairs, kind = self.molecule.topology.special(self.molecule.natoms)
        own = {(int(i), int(j), int(k)) for (i, j), k in zip(pairs, kind)}
        if given != own:
            i, j, k = sorted(given ^ own)[0]
            raise self._fail(f"Special Bonds and Bonds do not agree: atoms {i + 1} and {j + 1}, 1-{k + 1}; leave the sections out, they "
                             "follow from the bonds")


__all__ = ["Offsets", "from_json", "read"]
