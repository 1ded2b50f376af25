r"""Second derivatives of embedded-atom potentials.

With pairs' effective energies $$e_{ij}(r) = \phi_{ij} + F'_i \rho_{ij} + F'_j \rho_{ji}$$ at fixed slopes F' of the embedding functions,
$$H = \sum_{i<j} \nabla\nabla e_{ij} + \sum_i F''_i\, \nabla \rho_i \nabla \rho_i^T .$$
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from asemd.manybody_term import all_pairs

VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@dataclass
class Curvature:
    """Second derivatives of one embedded-atom style.

    Attributes
    ----------
    atoms (m, 2), d (m, 3), a (m,), b (m,)
        Pairs: rows of the atoms, the vector from the second to the first; by it the matrix is ``a I + b d d^T``.
    second (n,)
        Second derivatives of the embedding energies.
    density : sparse (3 n, n)
        Derivatives of the densities by positions.
    strained (6, n)
        Derivatives of the densities by Lagrangian strains, in Voigt's notation.
    """

    atoms: np.ndarray
    d: np.ndarray
    a: np.ndarray
    b: np.ndarray
    second: np.ndarray
    density: sparse.csr_matrix
    strained: np.ndarray

    def matrix(self) -> sparse.csr_matrix:
        """The part of the embedding functions in the matrix of second derivatives by positions."""
        return self.density @ sparse.diags(self.second) @ self.density.T


def _functions(table: np.ndarray, row: np.ndarray, first: int, t: np.ndarray, inverse: float) -> tuple[np.ndarray, ...]:
    """Values of one function of a block of tables, first and second derivatives."""
    a, b, c, e = table[row, first:first + 4].T
    return ((a * t + b) * t + c) * t + e, ((3.0 * a * t + 2.0 * b) * t + c) * inverse, (6.0 * a * t + 2.0 * b) * inverse**2


def of_embedded(engine, term) -> Curvature:
    """`Curvature` of a term of an embedded-atom potential in the engine's present positions; tables as in `asemd.embedded`."""
    s, n, constants = engine.state, engine.system.n, term.tables.constants
    table, offset, functions, function_of, share = term.tables.arrays[:5]
    i, j, code, shifts, _ = all_pairs(engine)
    d = s.x[:, i].T - s.x[:, j].T - shifts[code >> 2]
    r2 = (d * d).sum(axis=1)
    near = np.flatnonzero(r2 < term.tables.rows[0][s.type[i], s.type[j]])
    i, j, d, r = i[near], j[near], d[near], np.sqrt(r2[near])
    ti, tj, inverse = s.type[i], s.type[j], constants[0]
    m = np.minimum((r * inverse).astype(np.int64), int(constants[1]))
    t = np.minimum(r * inverse - m, 1.0)
    at_i, slope_i, curve_i = _functions(table, offset[ti, tj] + m, 0, t, inverse)
    at_j, slope_j, curve_j = _functions(table, offset[tj, ti] + m, 0, t, inverse)
    z, slope_z, curve_z = _functions(table, offset[ti, tj] + m, 4, t, inverse)
    rows = s.row[i], s.row[j]
    density = np.bincount(rows[0], at_i, n) + np.bincount(rows[1], at_j, n)
    slope, second = _embedding(density, functions, function_of[engine.system.type], constants)
    factor = float(term.owner.use.factor)
    slope, second = (factor * share[engine.system.type] * v for v in (slope, second))
    phi = factor * z / r
    slope_phi = (factor * slope_z - phi) / r
    curve_phi = (factor * curve_z - 2.0 * slope_phi) / r
    one = slope_phi + slope[rows[0]] * slope_i + slope[rows[1]] * slope_j
    two = curve_phi + slope[rows[0]] * curve_i + slope[rows[1]] * curve_j
    along, k = d / r[:, None], np.arange(3)
    numbers = np.concatenate([slope_i[:, None] * along, -slope_i[:, None] * along, slope_j[:, None] * along, -slope_j[:, None] * along])
    places = np.concatenate([3 * rows[a][:, None] + k for a in (0, 1, 0, 1)]).astype(np.int64)
    columns = np.repeat(np.concatenate([rows[a] for a in (0, 0, 1, 1)]), 3)
    strained = np.array([np.bincount(rows[0], slope_i * d[:, a] * along[:, b], n) + np.bincount(rows[1], slope_j * d[:, a] * along[:, b], n)
                         for a, b in VOIGT])
    by = sparse.coo_matrix((numbers.ravel(), (places.ravel(), columns)), shape=(3 * n, n)).tocsr()
    return Curvature(np.stack(rows, axis=1), d, one / r, (two - one / r) / r**2, second, by, strained)


def _embedding(density: np.ndarray, functions: np.ndarray, first_row: np.ndarray, constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivatives of the embedding energies; beyond the table they are linear, or held."""
    p = (density - constants[6]) * constants[3]
    m = np.clip(p.astype(np.int64), int(constants[5]), int(constants[4]) - 1)
    t = p - m
    low = -1.0 if constants[5] > 0.0 else -np.inf
    inside, served = (t <= 1.0) & (t >= low), first_row >= 0
    _, slope, second = _functions(functions, np.maximum(first_row, 0) + m, 0, np.clip(t, low, 1.0), constants[3])
    held = (t > 1.0) & (density <= constants[7]) & (constants[8] == 0.0)
    return np.where(served & ~held, slope, 0.0), np.where(served & inside, second, 0.0)
