"""Files of many-body potentials, as LAMMPS reads them: words in records that may go over several lines, comments after ``#``.

The first line may name the units the numbers are in, ``UNITS: metal``; energies are then converted between metal and real units. Every
error names the file and the line.
"""
from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from asemd.errors import InputError, Where
from asemd.tabulated import find_file, lines_of_file
from asemd.words import real

EV = 23.060549     # kcal/mol, LAMMPS's factor between real and metal
CONVERT = {("metal", "real"): EV, ("real", "metal"): 1.0 / EV, ("metal", "ase"): 1.0, ("real", "ase"): 1.0 / EV}


class Record:
    """Words of one record, taken one by one.

    Attributes
    ----------
    words : list of str
    where : Where
        Its first line.
    """

    def __init__(self, words: list[str], where: Where, what: str):
        self.words, self.where, self.what, self.at = words, where, what, 0

    def word(self, name: str = "a word") -> str:
        """The next word."""
        if self.at >= len(self.words):
            raise InputError(f"{self.what}: {name} is missing", self.where)
        self.at += 1
        return self.words[self.at - 1]

    def number(self, name: str = "a number") -> float:
        """The next word, a finite number; Fortran's exponents (1.0d-3) are refused as in LAMMPS."""
        return self._as(float, name, "a number")

    def whole(self, name: str = "a whole number") -> int:
        return self._as(int, name, "a whole number")

    def numbers(self, names: str) -> dict[str, Any]:
        """As many numbers as there are names, by name; ``*name`` is a word."""
        return {name.lstrip("*"): self.word(name[1:]) if name[0] == "*" else self.number(name) for name in names.split()}

    def _as(self, kind: Callable, name: str, expected: str):
        word = self.word(name)
        try:
            if not isfinite(real(word)) or not isfinite(value := kind(word)):
                raise ValueError
            return value
        except ValueError:
            raise InputError(f"{self.what}: {name} must be {expected}, got {word!r}", self.where) from None


def located(name: Any, what: str) -> str:
    """The name of a file that means the same in every folder: its path if it is here, as given if it is in a folder of potentials.

    Raises
    ------
    InputError
        It is neither; no name.
    """
    if not isinstance(name, (str, os.PathLike)):
        raise InputError(f"{what}: a file is a name or a path, got {name!r}")
    text = os.fspath(name)
    path = Path(text).expanduser()
    if path.is_file():
        return str(path.absolute())
    if path.name != text and not path.is_dir():     # scripts look for such a file in the folders of potentials, too
        raise InputError(f"{what}: cannot open file {text}: no such file")
    find_file(text, what)
    return text


def named_elements(elements: Mapping[str, str] | None, what: str) -> dict[str, str]:
    """Chemical symbol -> name in a file.

    Raises
    ------
    InputError
        No mapping, or not of words.
    """
    if elements is None:
        return {}
    if not isinstance(elements, Mapping) or not all(isinstance(word, str) for pair in elements.items() for word in pair):
        raise InputError(f"{what}: elements are chemical symbols with names in the file, as {{'C': 'CH'}}, got {elements!r}")
    return dict(elements)


class PotentialFile:
    """A potential file.

    Parameters
    ----------
    name : str
        As given in ``pair_coeff``: relative to the folder LAMMPS runs in, or in a folder of ``LAMMPS_POTENTIALS``.
    what : str
        The beginning of messages, ``pair_coeff sw``.

    Attributes
    ----------
    units, date : str
        Words after ``UNITS:`` and ``DATE:`` in the first line; empty without.
    lines : list of (int, str)
        Number and text of each line that is not empty without its comment.
    """

    def __init__(self, name: str, what: str):
        self.name, self.what, self.path = name, what, Path(find_file(name, what))
        text = lines_of_file(self.path, name, what)
        tags = text[0].split() if text else []
        self.units, self.date = (tags[tags.index(t) + 1] if t in tags[:-1] else "" for t in ("UNITS:", "DATE:"))
        self.raw = text
        stripped = ((k, line.split("#")[0].strip()) for k, line in enumerate(text, 1))
        self.lines = [(k, line) for k, line in stripped if line]

    def where(self, line: int) -> Where:
        """A place in the file, counted from 1."""
        return Where(self.name, line, self.raw[line - 1].strip() if 0 < line <= len(self.raw) else "")

    def error(self, message: str, line: int) -> InputError:
        return InputError(f"{self.what}: {message}", self.where(line))

    def records(self, count: int) -> Iterator[Record]:
        """Records of at least `count` words: a line, and those that follow while there are fewer; more words on its last line count too."""
        words: list[str] = []
        first = 0
        for number, line in self.lines:
            first = first if words else number
            words += line.split()
            if len(words) >= count:
                yield Record(words, self.where(first), self.what)
                words = []
        if words:
            raise self.error(f"the last entry needs {count} words, got {len(words)}", first)

    def factor(self, units: str) -> float:
        """Factor from energies of the file to those of a unit style.

        Raises
        ------
        InputError
            The file is in units that are not converted.
        """
        if not self.units or not units or self.units == units:
            return 1.0
        if (self.units, units) not in CONVERT:
            raise self.error(f"the file is in {self.units} units, but {units} units are in use", 1)
        return CONVERT[self.units, units]


def read_elements(file: PotentialFile, elements: Sequence[str], names: str, wrong: Callable[[dict], str]) -> dict[str, dict[str, float]]:
    """A file with a line for each element: its name and numbers with these `names`; others than `elements` do not count.

    Parameters
    ----------
    wrong : callable
        ``wrong(numbers)`` says what is wrong with the numbers of an element, if anything is.

    Raises
    ------
    InputError
        An element is missing or twice there, or its numbers are wrong.
    """
    found: dict[str, dict[str, float]] = {}
    for record in file.records(1 + len(names.split())):
        element, numbers = record.word("an element"), record.numbers(names)
        if element not in elements:
            continue
        bad = "it is there twice" if element in found else wrong(numbers)
        if bad or not all(map(math.isfinite, numbers.values())):
            raise InputError(f"{file.what}: element {element}: {bad or 'its numbers must be finite'}", record.where)
        found[element] = numbers
    for element in elements:
        if element not in found:
            raise file.error(f"element {element} is not in the potential file", 1)
    return found


def file_among(words: Sequence[str], begin: int, what: str, *others: str) -> int:
    """The place of the first word from `begin` on that is a file, or one of `others`.

    Raises
    ------
    InputError
        None is.
    """
    for k in range(begin, len(words)):
        if words[k] in others:
            return k
        try:
            find_file(words[k], what)
            return k
        except InputError:
            continue
    raise InputError(f"{what}: none of {' '.join(words[begin:]) or 'the words'} is a file here or in a folder of LAMMPS_POTENTIALS")
