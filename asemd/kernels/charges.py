"""Loops over pairs of atoms for charges that are found from their energy: products with its matrix, and elements of it."""
from __future__ import annotations

import math

from asemd.kernels.target import njit
from asemd.pair import coul_streitz

cloud_and_point, two_clouds = njit(coul_streitz.cloud_and_point), njit(coul_streitz.two_clouds)


@njit(cache=True, nogil=True)
def times(i, j, h, diagonal, x, out):
    """``out (n,)`` becomes the product of a symmetric matrix and `x`: its `diagonal (n,)`, and elements `h (m,)` at ``i, j (m,)``."""
    for k in range(len(x)):
        out[k] = diagonal[k] * x[k]
    for k in range(len(i)):
        out[i[k]] += h[k] * x[j[k]]
        out[j[k]] += h[k] * x[i[k]]


@njit(cache=True, nogil=True)
def slater(i, j, r, zeta, nucleus, alpha, h, field):
    """Elements `h (m,)` of pairs at distances `r` of ions with clouds of charge, without the constant of energy: exponents `zeta (n,)`;
    ``field (n,)`` becomes the potential of the effective nuclei of the others, `nucleus (n,)` their charges."""
    for k in range(len(i)):
        a, b = i[k], j[k]
        c = two_clouds(r[k], zeta[a], zeta[b])[0]
        h[k] = math.erfc(alpha * r[k]) / r[k] + c
        field[a] += nucleus[b] * (cloud_and_point(r[k], zeta[a])[0] - c)
        field[b] += nucleus[a] * (cloud_and_point(r[k], zeta[b])[0] - c)
