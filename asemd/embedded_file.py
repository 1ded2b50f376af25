"""Files of embedded-atom potentials: funcfl, setfl and what was made of it, read as LAMMPS reads them.

A funcfl file (``pair_style eam``) has one comment line, a line with atomic number and mass, a line ``Nrho drho Nr dr cutoff``, then the
values of F(rho), Z(r), rho(r). A setfl file (``eam/alloy``) has three comment lines, a line with the elements, the same numbers, for each
element F(rho) and rho(r), then r phi(r) for each pair of elements. In a file of style ``eam/fs`` there are densities for each ordered pair
of elements; ``eam/he`` also has the largest density in its line of numbers; ``eam/cd`` ends with a polynomial, ``adp`` with the functions u
and w of each pair. Arrays begin on a line of their own and may go over several.
"""
from __future__ import annotations

import re
import warnings
from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError, InputWarning
from asemd.potential_file import PotentialFile, Record
from asemd.words import real


@dataclass
class Funcfl:
    """One element with its atomic number: `embedding (nrho,)`, effective charges `charge (nr,)`, `density (nr,)`."""

    number: int
    mass: float
    drho: float
    dr: float
    cut: float
    embedding: np.ndarray
    charge: np.ndarray
    density: np.ndarray


@dataclass
class Setfl:
    """Several elements.

    Attributes
    ----------
    elements : tuple of str
    masses : (m,)
    rhomin, rhomax : float
        Densities of the first and the last value of the embedding functions.
    embedding : (m, nrho)
    density : (m, nr), or (m, m, nr)
        Of an element, or ``density[a, b]`` of an atom of element a at one of element b (styles fs and he).
    pair : dict of (a, b) with a >= b
        Values of r phi(r), (nr,); `u` and `w` are those of adp.
    polynomial : (k,)
        Coefficients of h(x), constant first (style cd).
    """

    elements: tuple[str, ...]
    masses: np.ndarray
    drho: float
    dr: float
    cut: float
    rhomin: float
    rhomax: float
    embedding: np.ndarray
    density: np.ndarray
    pair: dict[tuple[int, int], np.ndarray]
    u: dict[tuple[int, int], np.ndarray] = field(default_factory=dict)
    w: dict[tuple[int, int], np.ndarray] = field(default_factory=dict)
    polynomial: np.ndarray = field(default_factory=lambda: np.zeros(0))


class Lines:
    """The lines of a file one after the other; comments after ``#`` and empty lines count only where lines are skipped."""

    def __init__(self, file: PotentialFile):
        self.file, self.at = file, 0

    def skip(self, count: int) -> None:
        """Leave out lines, whatever is in them."""
        self.at += count
        if self.at > len(self.file.raw):
            raise self.ended("a comment line")

    def ended(self, what: str) -> InputError:
        return self.file.error(f"the file ends before {what}", len(self.file.raw))

    def record(self, what: str) -> Record:
        """The words of the next line that has some."""
        while self.at < len(self.file.raw):
            self.at += 1
            words = self.file.raw[self.at - 1].split("#")[0].split()
            if words:
                return Record(words, self.file.where(self.at), self.file.what)
        raise self.ended(what)

    def array(self, count: int, what: str) -> np.ndarray:
        """The next `count` numbers; what follows on their last line does not count."""
        out, n = np.empty(count), 0
        while n < count:
            record = self.record(f"{what}, which has {count} values, {n} of them were read")
            words = record.words[:count - n]
            try:
                values = np.array([real(w) for w in words])
            except ValueError:
                for _ in words:
                    record.number(f"a value of {what}")      # raises, with the word
                raise
            if not np.isfinite(values).all():
                raise self.file.error(f"a value of {what} is not a finite number", self.at)
            out[n:n + len(values)] = values
            n += len(values)
        if len(record.words) > len(words):
            self.warn(f"{what} has {count} values, what follows on the line of its last one is left out")
        return out

    def end(self) -> None:
        """Warn of numbers behind the last table."""
        for line in self.file.raw[self.at:]:
            self.at += 1
            if re.match(r"\s*[-+.]?\d", line):
                return self.warn("the file goes on where it should end: is a number of values too small?")

    def warn(self, message: str) -> None:
        warnings.warn(f"{self.file.what}: {message} ({self.file.where(self.at)})", InputWarning, stacklevel=4)

    def grid(self, record: Record, name: str, spacing: str) -> tuple[int, float]:
        """Number of values and their distance."""
        count, step = record.whole(name), record.number(spacing)
        if count < 5:
            raise InputError(f"{self.file.what}: {name} must be at least 5, got {count}", record.where)
        if not step > 0.0:
            raise InputError(f"{self.file.what}: {spacing} must be positive, got {step:g}", record.where)
        return count, step

    def sizes(self) -> tuple[int, float, int, float, float, Record]:
        """The line ``Nrho drho Nr dr cutoff``, and what is left of it."""
        record = self.record("the line Nrho drho Nr dr cutoff")
        sizes = *self.grid(record, "Nrho", "drho"), *self.grid(record, "Nr", "dr"), record.number("the cutoff")
        if not sizes[4] > 0.0:
            raise InputError(f"{self.file.what}: the cutoff must be positive, got {sizes[4]:g}", record.where)
        return *sizes, record

    def element(self, of: str = "") -> tuple[int, float]:
        """The line with atomic number and mass."""
        record = self.record(f"the line with atomic number and mass{of}")
        number = record.whole("the atomic number")
        mass = record.number("the mass")
        if not mass > 0.0:
            raise InputError(f"{self.file.what}: the mass must be positive, got {mass:g}", record.where)
        return number, mass


def read_funcfl(file: PotentialFile) -> Funcfl:
    """A file of one element, ``pair_style eam``.

    Raises
    ------
    InputError
        Something is missing or no number; the message names file and line.
    """
    lines = Lines(file)
    lines.skip(1)
    number, mass = lines.element()
    nrho, drho, nr, dr, cut, _ = lines.sizes()
    tables = lines.array(nrho, "F(rho)"), lines.array(nr, "Z(r)"), lines.array(nr, "rho(r)")
    lines.end()
    return Funcfl(number, mass, drho, dr, cut, *tables)


def elements_of(file: PotentialFile) -> tuple[str, ...]:
    """The elements of a setfl file."""
    return _elements(Lines(file))[0]


def _elements(lines: Lines) -> tuple[tuple[str, ...], Record]:
    lines.skip(3)
    record = lines.record("the line with the elements")
    count = record.whole("the number of elements")
    elements = tuple(record.words[1:])
    if count < 1 or len(elements) != count:
        named = " ".join(elements) or "none"
        raise InputError(f"{lines.file.what}: {count} elements are announced, {len(elements)} named: {named}", record.where)
    return elements, record


def read_setfl(file: PotentialFile, chosen, *, pairs: bool = False, rhomax: bool = False, polynomial: bool = False,
               angular: bool = False) -> Setfl:
    """A file of several elements.

    Parameters
    ----------
    chosen : sequence of str
        Elements that must be there.
    pairs, rhomax, polynomial, angular : bool
        The file is one of style fs or he, has the largest density (he), a polynomial (cd), functions u and w (adp).

    Raises
    ------
    InputError
        An element is not there; something is missing or no number. The message names file and line.
    """
    lines = Lines(file)
    elements, record = _elements(lines)
    count = len(elements)
    if polynomial and count != 2:
        raise InputError(f"{file.what}: the file must have two elements, it has {count}", record.where)
    for element in chosen:
        if element not in elements:
            raise InputError(f"{file.what}: element {element} is not in the potential file, which has {' '.join(elements)}", record.where)
    nrho, drho, nr, dr, cut, record = lines.sizes()
    top = record.number("the largest density") if rhomax else (nrho - 1) * drho
    masses, embedding, density = [], [], []
    for a in elements:
        masses.append(lines.element(f" of {a}")[1])
        embedding.append(lines.array(nrho, f"F(rho) of {a}"))
        if pairs:
            density.append([lines.array(nr, f"rho(r) of {a} at {b}") for b in elements])
        else:
            density.append(lines.array(nr, f"rho(r) of {a}"))
    tables = [{(a, b): lines.array(nr, f"{name} of {elements[a]} and {elements[b]}") for a in range(count) for b in range(a + 1)}
              for name in ("r phi(r)", *(("u(r)", "w(r)") if angular else ()))]
    h = np.zeros(0)
    if polynomial:
        lines.skip(1)
        record = lines.record("the polynomial h(x)")
        degree = record.whole("the degree of h(x)")
        if degree < 0:
            raise InputError(f"{file.what}: the degree of h(x) must not be negative, got {degree}", record.where)
        h = np.array([record.number(f"coefficient {k} of h(x)") for k in range(degree + 1)])
    lines.end()
    return Setfl(elements, np.array(masses), drho, dr, cut, top - (nrho - 1) * drho if rhomax else 0.0, top, np.array(embedding),
                 np.array(density), *tables, polynomial=h)
