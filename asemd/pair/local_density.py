r"""$$E = \sum_k \sum_i a^k_i F_k \Big( \sum_{j \neq i} b^k_j \varphi_k(r_{ij}) \Big), \qquad
\varphi_k(r) = \frac{(R_2^2 - r^2)^2 (R_2^2 + 2 r^2 - 3 R_1^2)}{(R_2^2 - R_1^2)^3} \quad R_1 < r < R_2$$

Local densities of coarse-grained molecules: an energy of each central atom (a = 1 for its type) that depends on how many neighbours (b = 1
for their types) it has; phi is 1 below R1 and 0 beyond R2. The file has two lines that do not count, then the number of potentials and of
values, then for each potential R1 and R2, the types of central atoms, the types of neighbours, the first and the last density and the step
between them (which follows from the other numbers), and the values of F. F is a cubic spline that is flat at both ends and stays as it is
beyond them.  Sanyal and Shell, J. Chem. Phys. 145, 034109 (2016).
"""
from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from asemd.embedded_file import Lines
from asemd.errors import InputError
from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.kernels.threads import barrier
from asemd.manybody import ManyBody
from asemd.pairstyle import PairTables
from asemd.potential_file import PotentialFile
from asemd.style import register

ENERGY = PER_ATOM = False


def density_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                   grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """As `asemd.kernels.manybody.site_forces`; `shared` gets the slope of each potential at each atom.

    `arrays`: R1^2, R2^2, first density, values per density of each potential; central and neighbour, 0 or 1, by potential and type; the
    polynomials (potentials, intervals, 4).
    """
    wells, central, counted, functions = arrays
    last_interval = functions.shape[1] - 1
    for i in range(lo, hi):
        ti = type_of[i]
        n = gather_near(i, first[i], last[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(wells.shape[0]):
            shared[k, i] = 0.0
            if central[k, ti] == 0.0:
                continue
            low, high = wells[k, 0], wells[k, 1]
            rho = 0.0
            for m in range(n):
                s = min(max(near[3, m], low), high)
                rho += counted[k, types[m]] * (high - s) * (high - s) * (high + 2.0 * s - 3.0 * low) / (high - low) ** 3
            p = min(max((rho - wells[k, 2]) * wells[k, 3], 0.0), last_interval + 1.0)
            row = min(int(p), last_interval)
            t = p - row
            a, b, c, d = functions[k, row, 0], functions[k, row, 1], functions[k, row, 2], functions[k, row, 3]
            shared[k, i] = ((3.0 * a * t + 2.0 * b) * t + c) * wells[k, 3]
            e = ((a * t + b) * t + c) * t + d
            if ENERGY:
                acc[0] += e
            if PER_ATOM:
                atom_energy[i] += e
    barrier(meeting)
    for i in range(lo, hi):
        ti = type_of[i]
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for m in range(n):
            g = 0.0
            for k in range(wells.shape[0]):
                low, high = wells[k, 0], wells[k, 1]
                s = min(max(near[3, m], low), high)
                both = counted[k, types[m]] * shared[k, i] + counted[k, ti] * shared[k, slots[m]]
                g += 12.0 * both * (high - s) * (low - s) / (high - low) ** 3
            grad[0, m], grad[1, m], grad[2, m] = g * near[0, m], g * near[1, m], g * near[2, m]
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), m, 0.0, grad[0, m], grad[1, m], grad[2, m])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)


@dataclass
class Potential:
    """One potential: its distances, types, and values of F at equidistant densities from `low` to `high`."""

    inner: float
    outer: float
    central: list[int]
    counted: list[int]
    low: float
    high: float
    values: np.ndarray


def read_potential(lines: Lines, count: int) -> Potential:
    """The next potential of a file.

    Raises
    ------
    InputError
        Something is missing or no number; the message names file and line.
    """
    record = lines.record("R1 and R2")
    inner, outer = record.number("R1"), record.number("R2")
    if not 0.0 <= inner < outer < math.inf:
        raise InputError(f"{record.what}: R1 must be less than R2 and not negative, got {inner:g} and {outer:g}", record.where)
    kinds = []
    for what in ("central atoms", "neighbours"):
        record = lines.record(f"the types of {what}")
        kinds.append([record.whole(f"a type of {what}") for _ in record.words])
        if min(kinds[-1]) < 1:
            raise InputError(f"{record.what}: a type of {what} must be at least 1, got {min(kinds[-1])}", record.where)
    record = lines.record("the first and the last density and the step")
    low, high, _ = (record.number(name) for name in ("the first density", "the last density", "the step of densities"))
    if not low < high < math.inf:
        raise InputError(f"{record.what}: the first density must be less than the last one, got {low:g} and {high:g}", record.where)
    return Potential(inner, outer, *kinds, low, high, lines.array(count, "F(rho)"))


class LocalDensity(ManyBody):
    """Any number of potentials; the file is for all types."""

    half_list = True

    def __init__(self, name: str, **options):
        super().__init__(name, forces=density_forces, elements=False, coeff="file", units={"file": "path"}, converts=False, **options)

    def read(self, file, elements, settings):
        lines = Lines(file)
        lines.skip(2)
        record = lines.record("the numbers of potentials and of values")
        number, count = record.whole("the number of potentials"), record.whole("the number of values")
        if number < 1 or count < 2:
            raise InputError(f"{file.what}: there must be at least 1 potential and 2 values, got {number} and {count}", record.where)
        return [read_potential(lines, count) for _ in range(number)]

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        file = PotentialFile(values["file"], f"pair_coeff {self.name}")
        data = self.read(file, (), settings)
        return {**values, "data": data, "units": file, "reach": max(p.outer for p in data)}

    def keys(self, values, keys):
        n = max(j for _, j in keys)
        if len(keys) != n * (n + 1) // 2:
            raise InputError(f"pair_coeff {self.name} must be for all types at once: pair_coeff * * {values['file']}")
        for p in values["data"]:
            if max(*p.central, *p.counted) > n:
                raise InputError(f"pair_coeff {self.name}: {values['file']} names type {max(*p.central, *p.counted)}, but there are {n}")
        return keys

    def lines(self, coeffs):
        return [((0, 0), ["*", "*"], self.format_coeff(c)) for c in {c["file"]: c for c in coeffs.values()}.values()]

    def bind(self, settings, coeffs, compat=""):
        return with_potentials(self, max((len(c["data"]) for c in coeffs.values()), default=0))

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        from scipy.interpolate import CubicSpline
        c = next(iter(filled.values()))
        self.unit_factor(c, units)
        data: list[Potential] = c["data"]
        rows, types = np.zeros((1, ntypes + 1, ntypes + 1)), np.zeros((2, len(data), ntypes + 1))
        for i, j in filled:
            rows[0, i, j] = rows[0, j, i] = c["reach"] ** 2
        for k, p in enumerate(data):
            types[0, k, p.central], types[1, k, p.counted] = 1.0, 1.0
        wells = np.array([[p.inner**2, p.outer**2, p.low, (len(p.values) - 1) / (p.high - p.low)] for p in data])
        functions = [CubicSpline(np.arange(len(p.values)), p.values, bc_type="clamped").c.T for p in data]
        return PairTables(rows, np.zeros(1), (wells, *types, np.ascontiguousarray(functions)))


@cache
def with_potentials(style: LocalDensity, number: int) -> LocalDensity:
    """The style with room for the slopes of so many potentials; one object for each number, so that kernels are found again."""
    twin = copy.copy(style)
    twin.shares = number
    return twin


register(LocalDensity("local/density", helpers=(), example="water.ld", see="LAMMPS manual, pair_style local/density"))
