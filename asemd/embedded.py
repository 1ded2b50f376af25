r"""Embedded-atom potentials: what the styles eam, eam/alloy, eam/fs, eam/he, eam/cd and adp have in common.

$$E = \sum_i F_i(\rho_i) + \sum_{i<j} \phi_{ij}(r_{ij}), \qquad \rho_i = \sum_{j \neq i} \rho_{ij}(r_{ij})$$

Functions are cubic polynomials between the values of a file. Arrays of the kernels, with blocks of rows for the ordered pairs of elements
in use (a pair of types finds its block by `offset`, pairs that do not interact find rows of zeros):

- `table (blocks * rows, 8 or 16)`: coefficients of t^3, t^2, t, 1 of the density that an atom of the second element makes at one of the
  first, then of r phi(r), and in adp of u and w; interval k begins at row k, a row of zeros is behind the last one.
- `offset (ntypes + 1, ntypes + 1)`: first row of the block of two types.
- `functions (elements * intervals, 4)`: embedding functions; `function_of (ntypes + 1,)`: their first rows, -1 for types without one.
- `share (ntypes + 1,)`: factors of the embedding energies (``fix adapt ... scale``).
- constants: 1/dr, the last interval and the row of zeros of a block, 1/drho, intervals of an embedding function, the first of them that
  counts, smallest and largest density, whether the slope goes on where the embedding energy is held.

Between the last value of a table and the cutoff, which are less than one interval apart, LAMMPS holds the energy but goes on with the last
slope as force; so do we, for what is held is what rounds off the table. Where it holds an embedding energy in the same way (funcfl files,
and eam/cd beyond the largest density), our force is the gradient of that energy; ``compat="lammps"`` takes the slope that the table ends
with.
"""
from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from asemd.embedded_file import Funcfl, Setfl, read_funcfl, read_setfl
from asemd.errors import InputError
from asemd.kernels import embedded as kernels
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables, missing_pairs
from asemd.potential_file import PotentialFile
from asemd.splines import polynomials, resampled

HARTREE_BOHR = 27.2 * 0.529      # eV A, the product that funcfl files go with


def radial(values: np.ndarray) -> np.ndarray:
    """Rows of one function of the distance: its intervals, and zeros."""
    return np.concatenate([polynomials(values), np.zeros((1, 4))])


def pair_part(tables: PairTables, i: int, j: int, r2: float) -> tuple[float, float]:
    """Energy and force between two atoms of types i and j that are not in any density, at a squared distance."""
    if not 0.0 < r2 < tables.rows[0, i, j]:
        return 0.0, 0.0
    r = math.sqrt(r2)
    p = r * tables.constants[0]
    m = min(int(p), int(tables.constants[1]))
    t = min(p - m, 1.0)
    a, b, c, d = tables.arrays[0][tables.arrays[1][i, j] + m, 4:8].tolist()
    phi = (((a * t + b) * t + c) * t + d) / r
    return phi, (phi - ((3.0 * a * t + 2.0 * b) * t + c) * tables.constants[0]) / r


class Embedded(ManyBody):
    """A style whose file is a setfl file; `form` are options of `asemd.embedded_file.read_setfl`."""

    coefficients: tuple[str, ...] = ("scale",)      # what ``fix adapt`` may change
    half_list = True               # LAMMPS's log calls its list one of half the pairs
    ends = False                   # whether forces go on with the last slope of an embedding function, as in LAMMPS

    def __init__(self, name: str, *, forces=kernels.embedded_forces, helpers=(kernels.embedding,), shares=1, form=None, **options):
        super().__init__(name, forces=forces, helpers=helpers, shares=shares, **options)
        self.form = form or {}
        self.reads = "eam/alloy" if name.startswith("eam/cd") else name      # the word for it in LAMMPS's log

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        if "_twin" not in vars(self):
            self._twin = copy.copy(self)
            self._twin.ends = True
        return self._twin

    @property
    def packable(self) -> bool:
        """Whether there is a kernel over clusters (`asemd.embedded_term`)."""
        return self.forces is kernels.embedded_forces

    def read(self, file: PotentialFile, elements, settings) -> Setfl:
        return read_setfl(file, elements, **self.form)

    def join(self, old, new):
        return {**new, "scale": 1.0}

    def masses(self, coeff: Mapping[str, Any], i: int) -> float:
        """Mass of atom type `i` by the file."""
        data = coeff["data"]
        return float(data.masses[data.elements.index(coeff["element"][i - 1])])

    def further(self, data: Setfl, factor: float) -> tuple[dict[tuple[int, int], np.ndarray], ...]:
        """More functions of the distance than density and r phi, by pair of elements."""
        return ()

    def pack_pairs(self, settings, filled, ntypes, units, shift=False) -> PairTables:
        data: Setfl = next(iter(filled.values()))["data"]
        factor = self.unit_factor(next(iter(filled.values())), units)
        names = element_of(filled, ntypes)
        number = [-1 if e is None else data.elements.index(e) for e in names]
        used = sorted({k for k in number if k >= 0})
        density = {(a, b): data.density[b, a] if data.density.ndim == 3 else data.density[b] for a in used for b in used}
        return tables_of(filled, ntypes, number, density, {(a, b): factor * data.pair[max(a, b), min(a, b)] for a in used for b in used},
                         factor * data.embedding, data.dr, data.drho, data.cut, data.rhomin, data.rhomax, bool(self.form.get("rhomax")),
                         self.ends, self.further(data, factor))


class EmbeddedFuncfl(Embedded):
    """Style eam: a file for each atom type, from which those for pairs of elements are mixed. As in LAMMPS, where coefficients are given
    for pairs of one type only, ``scale`` of such a pair does not change what it has with others."""

    def __init__(self, name: str, **options):
        super().__init__(name, elements=False, coeff="file", units={"file": "path"}, **options)

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        file = PotentialFile(values["file"], f"pair_coeff {self.name}")
        data = read_funcfl(file)
        return {**values, "data": data, "units": file, "reach": data.cut}

    def keys(self, values, keys):
        same = [(i, j) for i, j in keys if i == j]
        if not same:
            raise InputError(f"pair_coeff {self.name}: a file is for atoms of one type, give it as pair_coeff I I {values['file']}; pairs "
                             "of different types are mixed")
        return same

    def masses(self, coeff, i):
        return coeff["data"].mass

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        pairs = only if only is not None else {(i, j) for i in range(1, ntypes + 1) for j in range(i, ntypes + 1)}
        missing = sorted({(t, t) for pair in pairs for t in pair} - set(coeffs))
        if missing:
            raise InputError(missing_pairs(missing))
        reach = max((coeffs[t, t]["reach"] for pair in pairs for t in pair), default=0.0)
        return {(i, j): {"both": (coeffs[i, i], coeffs[j, j]), "reach": reach, "scale": coeffs[i, i].get("scale", 1.0) if i == j else 1.0,
                         "units": coeffs[i, i]["units"]} for i, j in sorted(pairs)}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        files: dict[str, Mapping[str, Any]] = {}
        number = [-1] * (ntypes + 1)
        for (i, j), c in filled.items():
            for t, one in zip((i, j), c["both"]):
                files.setdefault(one["file"], one)
                number[t] = list(files).index(one["file"])
        all_: list[Funcfl] = [c["data"] for c in files.values()]
        factors = [self.unit_factor(c, units) for c in files.values()]
        dr, drho = max(d.dr for d in all_), max(d.drho for d in all_)
        rmax, rhomax = max((len(d.charge) - 1) * d.dr for d in all_), max((len(d.embedding) - 1) * d.drho for d in all_)
        nr, nrho = int(rmax / dr + 0.5), int(rhomax / drho + 0.5)
        charge = [resampled(d.charge, d.dr, nr, dr) for d in all_]
        density = [resampled(d.density, d.dr, nr, dr) for d in all_]
        embedding = np.array([f * resampled(d.embedding, d.drho, nrho, drho) for f, d in zip(factors, all_)])
        every = range(len(all_))
        pair = {(a, b): (factors[a] * factors[b]) ** 0.5 * HARTREE_BOHR * charge[a] * charge[b] for a in every for b in every}
        return tables_of(filled, ntypes, number, {(a, b): density[b] for a in every for b in every}, pair, embedding, dr, drho,
                         max(d.cut for d in all_), 0.0, rhomax, False, self.ends)


def tables_of(filled, ntypes: int, number, density, pair, embedding: np.ndarray, dr: float, drho: float, cut: float, rhomin: float,
              rhomax: float, signed: bool, ends: bool, further=()) -> PairTables:
    """`PairTables` of an embedded-atom potential, see the head of this module.

    Parameters
    ----------
    number : sequence of int
        Element of each type, -1 for none.
    density, pair : dict of (a, b)
        Values (nr,) by the elements of an atom and its neighbour.
    signed : bool
        Densities may be negative (style he): the table ends at `rhomin`, too.
    ends : bool
        Forces go on with the last slopes of embedding functions.
    further : sequence of dict of (a, b) with a >= b
        More functions of the distance.
    """
    nr, nrho = len(next(iter(density.values()))), embedding.shape[1]
    cut2, offset = np.zeros((1, ntypes + 1, ntypes + 1)), np.zeros((ntypes + 1, ntypes + 1), np.int64)
    share, blocks, at = np.zeros(ntypes + 1), [np.zeros((nr, 8 + 4 * len(further)))], {}
    for (i, j), c in filled.items():
        cut2[0, i, j] = cut2[0, j, i] = cut * cut
        for s, t in ((i, j), (j, i)):
            key = number[s], number[t], c.get("scale", 1.0)
            if key not in at:
                at[key] = len(blocks)
                more = [radial(table[max(key[:2]), min(key[:2])]) for table in further]
                blocks.append(np.concatenate([radial(density[key[:2]]), key[2] * radial(pair[key[:2]]), *more], axis=1))
            offset[s, t] = at[key] * nr
        if i == j:
            share[i] = c.get("scale", 1.0)
    function_of = np.array([k * (nrho - 1) if k >= 0 else -1 for k in number], np.int64)
    constants = [1.0 / dr, nr - 2, nr - 1, 1.0 / drho, nrho - 1, 1.0 if signed else 0.0, rhomin, rhomax, float(ends)]
    functions = np.ascontiguousarray(polynomials(embedding).reshape(-1, 4))
    return PairTables(cut2, np.array(constants, float), (np.concatenate(blocks), offset, functions, function_of, share))
