"""Files of the modified embedded-atom method: a library of elements, and parameters of elements, pairs and triples.

An entry of the library has 19 words that may go over several lines, of meam/ms 25: element, lattice, z, atomic number, mass; alpha, b0 to
b3, [b1m b2m b3m], lattice constant, esub, asub; t0 to t3, [t1m t2m t3m], rozero, ibar. Parameters are lines ``keyword(I,J,K) = value``.
"""
from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from asemd.errors import InputError, nearest
from asemd.potential_file import PotentialFile, Record

NEIGHBORS = {"fcc": 12, "bcc": 8, "hcp": 12, "dim": 1, "dia": 4, "dia3": 4, "sc": 6, "lin": 2, "zig": 2, "tri": 2, "ch4": 4, "b1": 6,
             "c11": 10, "l12": 12, "b2": 8}
OF_ONE = ("fcc", "bcc", "hcp", "dim", "dia", "dia3", "sc", "lin", "zig", "tri")      # lattices of one element
# lattice constant -> nearest distance
NEAREST = {"fcc": 1.0 / math.sqrt(2.0), "bcc": math.sqrt(3.0) / 2.0, "dia": math.sqrt(3.0) / 4.0, "dia3": math.sqrt(3.0) / 4.0}
# keyword of the parameter file -> how many indices it has
INDICES = {"Ec": 2, "alpha": 2, "rho0": 1, "delta": 2, "lattce": 2, "attrac": 2, "repuls": 2, "nn2": 2, "Cmin": 3, "Cmax": 3, "rc": 0,
           "delr": 0, "augt1": 0, "gsmooth_factor": 0, "re": 2, "ialloy": 0, "mixture_ref_t": 0, "erose_form": 0, "zbl": 2,
           "emb_lin_neg": 0, "bkgd_dyn": 0, "theta": 2}
SORTED = ("nn2", "zbl", "theta")      # given for I J and J I alike
CHOICES = {"augt1": (0, 1), "ialloy": (0, 1, 2), "mixture_ref_t": (0, 1), "erose_form": (0, 1, 2), "emb_lin_neg": (0, 1),
           "bkgd_dyn": (0, 1)}


class Parameters:
    """All numbers of a set of elements.

    Attributes
    ----------
    elements : tuple of str
    number, mass, A, rho0, ibar : (m,)
    beta (m, 4), beta_m (m, 3), t (m, 3), t_m (m, 3)
    Ec, alpha, re, delta, attrac, repuls : (m, m)
        Of pairs of elements; energies in eV.
    nn2, zbl : (m, m) of int
    lattce : (m, m) of str
    theta : (m, m)
        Angle of the lattices lin, zig and tri, degrees.
    Cmin, Cmax : (m, m, m)
        Screening of the first two by the third.
    rc, delr, gsmooth_factor, augt1, ialloy, mixture_ref_t, erose_form, emb_lin_neg, bkgd_dyn
        As in the parameter file.
    """

    def __init__(self, elements: Sequence[str]):
        m = len(elements)
        self.elements = tuple(elements)
        self.number, self.mass, self.A, self.rho0, self.ibar = np.zeros((5, m))
        self.beta, self.beta_m, self.t, self.t_m = np.zeros((m, 4)), np.zeros((m, 3)), np.zeros((m, 3)), np.zeros((m, 3))
        self.Ec, self.alpha, self.re, self.delta, self.attrac, self.repuls = np.zeros((6, m, m))
        self.nn2, self.zbl = np.zeros((m, m), int), np.ones((m, m), int)
        self.lattce, self.theta = np.full((m, m), "fcc", object), np.full((m, m), 180.0)
        self.Cmin, self.Cmax = np.full((m, m, m), 2.0), np.full((m, m, m), 2.8)
        self.rc, self.delr, self.gsmooth_factor, self.augt1, self.ialloy = 4.0, 0.1, 99.0, 1, 0
        self.mixture_ref_t = self.erose_form = self.emb_lin_neg = self.bkgd_dyn = 0

    def complete(self) -> None:
        """Mixed values of pairs that were not given, t1 with its share of t3; to be called once, after the files are read."""
        self.t[:, 0] += self.augt1 * 3.0 / 5.0 * self.t[:, 2]
        m = len(self.elements)
        for i in range(m):
            for j in range(i + 1, m):
                a, b = self.Ec[i, i], self.Ec[j, j]
                if self.Ec[i, j] == 0.0:
                    mean = (a + b) / 2.0
                    if self.lattce[i, j] == "l12":
                        mean = (3.0 * a + b) / 4.0
                    elif self.lattce[i, j] == "c11":
                        mean = (2.0 * a + b) / 3.0 if self.lattce[i, i] == "dia" else (a + 2.0 * b) / 3.0
                    self.Ec[i, j] = mean - self.delta[i, j]
                for values in (self.alpha, self.re):
                    if values[i, j] == 0.0:
                        values[i, j] = (values[i, i] + values[j, j]) / 2.0
                for values in (self.Ec, self.alpha, self.re, self.attrac, self.repuls, self.lattce, self.nn2, self.theta, self.zbl,
                               self.Cmin, self.Cmax):
                    values[j, i] = values[i, j]


def read_library(file: PotentialFile, elements: Sequence[str], second: bool) -> Parameters:
    """The entries of these elements, the first one of each.

    Parameters
    ----------
    second : bool
        Entries have the numbers of meam/ms, too.

    Raises
    ------
    InputError
        An entry is not there, or something is wrong in it; the message names file and line.
    """
    made, found = Parameters(elements), set()
    for record in file.records(25 if second else 19):
        record.words = [w.strip("'\"") for w in record.words]
        name = record.word("an element")
        if name in made.elements and name not in found:
            found.add(name)
            _entry(made, made.elements.index(name), record, second)
    missing = [e for e in made.elements if e not in found]
    if missing:
        raise InputError(f"{file.what}: {file.name} has no entry for {' '.join(missing)}")
    return made


def _entry(made: Parameters, i: int, record: Record, second: bool) -> None:
    def wrong(message: str) -> InputError:
        return InputError(f"{record.what}: {made.elements[i]}: {message}", record.where)

    lattice = record.word("the lattice")
    if lattice not in OF_ONE:
        raise wrong(f"the lattice must be one of {' '.join(OF_ONE)}, got {lattice}")
    z = record.number("z")
    if z != NEIGHBORS[lattice]:
        raise wrong(f"z must be {NEIGHBORS[lattice]}, the number of neighbours in {lattice}, got {z:g}")
    made.lattce[i, i] = lattice
    made.number[i] = record.whole("the atomic number")
    made.mass[i], made.alpha[i, i] = record.number("the mass"), record.number("alpha")
    made.beta[i] = [record.number(f"b{k}") for k in range(4)]
    if second:
        made.beta_m[i] = [record.number(f"b{k}m") for k in (1, 2, 3)]
    length = record.number("the lattice constant")
    made.re[i, i] = length * NEAREST.get(lattice, 1.0)
    made.Ec[i, i], made.A[i] = record.number("esub"), record.number("asub")
    if (t0 := record.number("t0")) != 1.0:
        raise wrong(f"t0 must be 1, got {t0:g}")
    made.t[i] = [record.number(f"t{k}") for k in (1, 2, 3)]
    if second:
        made.t_m[i] = [record.number(f"t{k}m") for k in (1, 2, 3)]
    made.rho0[i], made.ibar[i] = record.number("rozero"), record.whole("ibar")
    if made.ibar[i] not in (0.0, 1.0, 3.0, 4.0, -5.0):
        raise wrong(f"ibar must be 0, 1, 3, 4 or -5, got {made.ibar[i]:g}")
    if not (length > 0.0 and made.mass[i] > 0.0):
        raise wrong("mass and lattice constant must be positive")


def read_parameters(file: PotentialFile, made: Parameters) -> None:
    """What a parameter file says, into `made`.

    Raises
    ------
    InputError
        An unknown keyword, an index that is no element, a value that makes no sense; the message names file and line.
    """
    m = len(made.elements)
    for number, line in file.lines:
        words = [w for w in re.split(r"[=(),'\"\s]+", line) if w]
        keyword = words[0] if words else ""
        if keyword not in INDICES:
            raise file.error(f"unknown keyword {keyword!r}{nearest(keyword, INDICES)}", number)
        record = Record(words[1:], file.where(number), f"{file.what}: {keyword}")
        wanted = INDICES[keyword]
        if len(words) < 2 + wanted:
            raise file.error(f"{keyword} needs {wanted} ind{'ex' if wanted == 1 else 'ices'} and a value", number)
        index = tuple(record.whole("an index") - 1 for _ in range(len(words) - 2))[:wanted]
        if any(not 0 <= k < m for k in index):
            raise file.error(f"indices of {keyword} are elements 1 to {m}, got {' '.join(str(k + 1) for k in index)}", number)
        if keyword in SORTED:
            index = tuple(sorted(index))
        if keyword == "lattce":
            lattice = record.word("a lattice")
            allowed = OF_ONE if index[0] == index[1] else NEIGHBORS
            if lattice not in allowed:
                raise file.error(f"the lattice of {' '.join(made.elements[k] for k in index)} must be one of {' '.join(allowed)}, got "
                                 f"{lattice}", number)
            made.lattce[index] = lattice
            continue
        value = record.number("the value")
        if keyword in CHOICES and value not in CHOICES[keyword]:
            raise file.error(f"{keyword} must be one of {' '.join(map(str, CHOICES[keyword]))}, got {value:g}", number)
        if keyword == "rho0":
            made.rho0[index] = value
        elif wanted:
            getattr(made, keyword)[index] = value
        else:
            setattr(made, keyword, value)
    if not (made.rc > 0.0 and made.delr > 0.0):
        raise InputError(f"{file.what}: {file.name}: rc and delr must be positive, got {made.rc:g} and {made.delr:g}")
