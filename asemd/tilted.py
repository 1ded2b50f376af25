"""Fractional coordinates of cells whose vectors are a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz).

Sums and products stand in LAMMPS's order: the last bit says on which side of a face an atom is.
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
