"""Fractional coordinates of cells whose vectors are a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz); short vectors of any lattice.

Sums and products of the former stand in LAMMPS's order: the last bit says on which side of a face an atom is.
"""
from __future__ import annotations

import numpy as np


def inverse(cell: np.ndarray) -> np.ndarray:
    """The inverse (3, 3) of a cell (3, 3)."""
    (lx, _, _), (xy, ly, _), (xz, yz, lz) = cell
    return np.array([[1.0 / lx, 0.0, 0.0], [-xy / (lx * ly), 1.0 / ly, 0.0],
                     [(yz * xy - ly * xz) / (lx * ly * lz), -yz / (ly * lz), 1.0 / lz]])


def fractional(d: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """Fractional coordinates (n, 3) of vectors (n, 3) from the origin."""
    h = inverse(cell)
    return np.column_stack([h[0, 0] * d[:, 0] + h[1, 0] * d[:, 1] + h[2, 0] * d[:, 2], h[1, 1] * d[:, 1] + h[2, 1] * d[:, 2],
                            h[2, 2] * d[:, 2]])


def positions(s: np.ndarray, cell: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Positions (n, 3) of fractional coordinates (n, 3)."""
    (lx, _, _), (xy, ly, _), (xz, yz, lz) = cell
    return np.column_stack([lx * s[:, 0] + xy * s[:, 1] + xz * s[:, 2] + origin[0], ly * s[:, 1] + yz * s[:, 2] + origin[1],
                            lz * s[:, 2] + origin[2]])


def reduced(vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A Minkowski-reduced basis of 1 to 3 lattice vectors, and its integer coordinates in the given ones."""
    basis, steps = vectors.copy(), np.eye(len(vectors))
    changed = len(basis) > 1
    while changed:
        changed = False
        for i in range(len(basis)):
            others = [j for j in range(len(basis)) if j != i]
            grids = np.meshgrid(*([-1.0, 0.0, 1.0],) * len(others), indexing="ij")
            trial = np.stack(grids, -1).reshape(-1, len(others))
            for j, other in enumerate(others):      # big steps first: subtract the projection
                n = np.rint(basis[i] @ basis[other] / (basis[other] @ basis[other]))
                trial = np.vstack([trial, -n * np.eye(len(others))[j]])
            length = ((basis[i] + trial @ basis[others]) ** 2).sum(axis=1)
            best = int(np.argmin(length))
            if length[best] < (basis[i] @ basis[i]) * (1.0 - 1e-12):
                basis[i] += trial[best] @ basis[others]
                steps[i] += trial[best] @ steps[others]
                changed = True
    return basis, steps
