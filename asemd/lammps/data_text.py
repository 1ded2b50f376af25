"""The outline of a LAMMPS data file: its lines, the header, where each section begins and ends, and whether both belong together."""
from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asemd.atom_style import bonded, has
from asemd.errors import InputError, InputWarning, Where, nearest
from asemd.lammps.data_format import COEFFS, HEADER, LABELS, REAL_HEADER, SECTIONS, TOPOLOGY, UNSUPPORTED
from asemd.lammps.data_lines import read_lines

_FOR_CMAP = ": it is for fix cmap, which must be there before: fix ID all cmap FILE, then read_data ... fix ID crossterm CMAP"
FOR_FIXES = {"crossterms": _FOR_CMAP, "CMAP": _FOR_CMAP}


@dataclass
class Section:
    name: str
    line: int            # index of the heading
    first: int           # lines[first:last] hold the values
    last: int
    hint: str


class DataText:
    """Lines, header and sections of a data file.

    Attributes
    ----------
    lines : Lines
    header : dict
        Header line -> its numbers; `header_line` has the index of the line.
    sections : dict of str to Section
    fixes : sequence of (ID, header, section)
        Header lines and sections with these words are for a fix (``read_data fix``), if the fix is among `readers`.
    """

    def __init__(self, path: str | os.PathLike, atom_style: str, fixes: Sequence[tuple[str, str, str]] = ()):
        self.path, self.lines, self.atom_style, self.fixes = os.fspath(path), read_lines(path), atom_style, fixes
        self.of_fixes: dict[str, list[Section]] = {}        # ID -> sections for it
        self.headers_of_fixes: dict[str, list[int]] = {}        # ID -> header lines for it
        self.header: dict[str, list[float]] = {}
        self.header_line: dict[str, int] = {}
        self.sections: dict[str, Section] = {}
        self.read_sections(self.read_header())
        self.check_promises()

    # ---- places and messages
    def where(self, index: int) -> Where:
        return Where(self.path, index + 1, self.lines[index] if index < len(self.lines) else "")

    def fail(self, message: str, index: int | None = None) -> InputError:
        return InputError(message, None if index is None else self.where(index))

    def warn(self, message: str, index: int) -> None:
        warnings.warn(f"{message} ({self.where(index)})", InputWarning, stacklevel=5)

    def content(self, section: Section) -> list[int]:
        """Indices of the lines of a section that hold values."""
        return [i for i in range(section.first, section.last) if self.lines[i].split("#", 1)[0].strip()]

    def fix_lines(self) -> dict[str, list[tuple[Where, list[str]]]]:
        """ID of a fix -> place and words of each line of its sections."""
        return {id: [(self.where(i), self.lines[i].split("#", 1)[0].split()) for s in sections for i in self.content(s)]
                for id, sections in self.of_fixes.items()}

    def fix_headers(self) -> dict[str, list[tuple[Where, list[str]]]]:
        """ID of a fix -> place and words of the header lines for it."""
        return {id: [(self.where(i), self.lines[i].split("#", 1)[0].split()) for i in lines] for id, lines in self.headers_of_fixes.items()}

    def number(self, word: str) -> int:
        return int(self.header.get(word, [0])[0])

    def read_header(self) -> int:
        """Header lines; returns the index of the first line of the body."""
        i = 1
        while i < len(self.lines):
            words = self.lines[i].split("#", 1)[0].split()
            if words:
                if words[0][0].isalpha():
                    break
                values, word = _leading_numbers(words)
                owner = next((id for id, header, *_ in self.fixes if header != "NULL" and header in self.lines[i]), None)
                if owner is not None:
                    self.headers_of_fixes.setdefault(owner, []).append(i)
                    i += 1
                    continue
                if word not in HEADER:
                    hint = FOR_FIXES.get(word, nearest(word, HEADER))
                    raise self.fail(f"unknown header line {' '.join(words)!r}{hint}", i)
                if len(values) != HEADER[word]:
                    raise self.fail(f"header line {word!r} needs {HEADER[word]} number{'s' * (HEADER[word] > 1)}, got {len(values)}", i)
                if word not in REAL_HEADER and (values[0] < 0 or values[0] != int(values[0])):
                    raise self.fail(f"the number of {word} must be a whole number, not negative", i)
                if self.header.get(word, values) != values:
                    raise self.fail(f"header line {word!r} appears twice (lines {self.header_line[word] + 1} and {i + 1})", i)
                self.header[word], self.header_line[word] = values, i
            i += 1
        return i

    def read_sections(self, start: int) -> None:
        """Find the headings."""
        current: Section | None = None
        for i in self.lines.beginning_with_letters(start).tolist():
            text, _, hint = self.lines[i].partition("#")
            name = " ".join(text.split())
            if name not in SECTIONS:
                for id, _, section, reads in self.fixes:
                    if section in name and not reads:
                        raise self.fail(f"section {name} is for fix {id}, which reads nothing from data files: remove the section", i)
                owner = next((id for id, _, section, _ in self.fixes if section in name), None)
                if owner is not None:
                    if current:
                        current.last = i
                    current = Section(name, i, i + 1, len(self.lines), "")
                    self.of_fixes.setdefault(owner, []).append(current)
                    continue
                if current and (not _is_heading(name) or self.takes_words(current.name, name)):
                    continue
                same = [s for s in SECTIONS if s.lower() == name.lower()]
                similar = nearest(same[0] if same else name, [*SECTIONS, *HEADER])
                raise self.fail(f"unknown section {name!r}{FOR_FIXES.get(name, similar)}", i)
            if name in UNSUPPORTED:
                raise self.fail(f"section {name} belongs to atom_style {UNSUPPORTED[name]}, which is not supported", i)
            if name in self.sections:
                raise self.fail(f"section {name} appears twice (lines {self.sections[name].line + 1} and {i + 1})", i)
            if current:
                current.last = i
            current = self.sections[name] = Section(name, i, i + 1, len(self.lines), " ".join(hint.split()[:1]))

    def takes_words(self, section: str, text: str) -> bool:
        """Whether a line made of words only can be a line of values: coefficients under a type label."""
        if section not in COEFFS:
            return False
        kind = "atom" if COEFFS[section][0] == "pair" else COEFFS[section][0]
        label = next((name for name, k in LABELS.items() if k == kind and name in self.sections), None)
        return label is not None and any(text.split()[0] in self.lines[i].split()[1:2] for i in self.content(self.sections[label]))

    def check_promises(self) -> None:
        """Header and sections must belong together."""
        if not self.header and not self.sections:
            raise self.fail(f"read_data: {self.path} has no header and no sections: it is no data file of LAMMPS")
        for word in UNSUPPORTED.values():
            plural = {"tri": "triangles", "body": "bodies"}.get(word, word + "s")
            if self.number(plural):
                raise self.fail(f"{plural} need atom_style {word}, which is not supported", self.header_line[plural])
        kinds = bonded(self.atom_style)
        first = self.sections.get("Atoms")
        for section in ("Velocities", "Ellipsoids", *TOPOLOGY):
            there = self.sections.get(section)
            if first and there and there.line < first.line:
                raise self.fail(f"section {section} must come after the section Atoms (line {first.line + 1})", there.line)
        if has(self.atom_style, "ellipsoid"):
            kinds = (*kinds, "ellipsoid")
        several = {"Ellipsoids": "ellipsoid", **TOPOLOGY}
        for section, word in (("Atoms", "atoms"), *((s, k + "s") for s, k in several.items())):
            n, there = self.number(word), self.sections.get(section)
            if section in several and (n or there) and several[section] not in kinds:
                place = there.line if there else self.header_line[word]
                raise self.fail(f"{word} are not possible with atom_style {self.atom_style}", place)
            if n and not there:
                raise self.fail(f"the header says {n} {word} but there is no {section} section (truncated file?)", self.header_line[word])
            if there and word not in self.header and self.content(there):
                raise self.fail(f'the header has no "{word}" line but there is a section {section}', there.line)
        if not self.number("atom types") and self.number("atoms"):
            raise self.fail(f'the header of {self.path} has no "atom types" line')

    def check_hints(self, units: str) -> None:
        """Warn of an atom style or units that the file names and that are others here."""
        hint = self.sections["Atoms"].hint if "Atoms" in self.sections else ""
        if hint and hint != self.atom_style.split()[0]:
            self.warn(f"Atoms section is said to be of style {hint}, but atom_style is {self.atom_style}", self.sections["Atoms"].line)
        said = self.lines[0].rpartition("units = ")[2].split()[:1] if "units = " in self.lines[0] else []
        if said and said[0] != units and units != "ase":
            self.warn(f"the file was written in units {said[0]}, but units is {units}", 0)


def _leading_numbers(words: list[str]) -> tuple[list[float], str]:
    """The numbers a header line begins with, and the words that follow."""
    values = []
    for w in words:
        try:
            value = float(w)
        except ValueError:
            break
        if not np.isfinite(value):
            break
        values.append(value)
    return values, " ".join(words[len(values):])


def _is_heading(text: str) -> bool:
    """Whether a line looks like a heading: a few words that all begin with a letter."""
    words = text.split()
    return len(words) <= 4 and all(w[0].isalpha() for w in words)
