r"""Index tables of bispectrum components: which products of expansion coefficients belong to which component.

The neighbours of an atom are a density on the three-sphere with coefficients $u^j_{m'm}$, j = 0, 1/2, ... Components are
$B_{j_1j_2j}=\sum u^{j*}_{m'm}Z^j_{m'm}$, $Z^j_{m'm}=\sum H\,u^{j_1}u^{j_2}$ with products H of two Clebsch-Gordan coefficients [1]_.
All j here are twice the usual ones, integers, and m from 0 to j.

.. [1] Thompson, Swiler, Trott, Foiles and Tucker, J. Comp. Phys. 285, 316 (2015)
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import factorial, sqrt

import numpy as np


@dataclass(frozen=True)
class Bispectrum:
    """Tables of all components up to a largest j.

    Attributes
    ----------
    components : tuple of (j1, j2, j)
        j2 <= j1 <= j, in LAMMPS's order.
    first (twojmax + 2,)
        Place of the first coefficient of each j; that of m' = b, m = a is ``first[j] + b (j + 1) + a``.
    weights (first[-1],)
        How often a coefficient counts where only those with 2b <= j are summed: the others are their mirror images.
    z (nz + 1, 4)
        Of each sum Z: its place among the coefficients, its component, in which of a component's three places it is (0: the last,
        1: the first, 2: the second), its first product; the last row is the end.
    factors (nz,)
        How much of Z there is in the derivative of the component by a coefficient of that place.
    products (n, 2), strengths (n,)
        Places of two coefficients, and H.
    roots (twojmax + 1, twojmax + 1)
        Square roots of p / q.
    """

    components: tuple[tuple[int, int, int], ...]
    first: np.ndarray
    weights: np.ndarray
    z: np.ndarray
    factors: np.ndarray
    products: np.ndarray
    strengths: np.ndarray
    roots: np.ndarray


def clebsch_gordan(j1: int, m1: int, j2: int, m2: int, j: int, m: int) -> float:
    """<j1 m1 j2 m2 | j m> with all arguments twice the usual ones."""
    if m1 + m2 != m:
        return 0.0
    half = [(j1 + j2 - j) // 2, (j1 - m1) // 2, (j2 + m2) // 2, (j - j2 + m1) // 2, (j - j1 - m2) // 2]
    total = 0.0
    for k in range(max(0, -half[3], -half[4]), min(half[:3]) + 1):
        parts = [k, half[0] - k, half[1] - k, half[2] - k, half[3] + k, half[4] + k]
        product = 1
        for n in parts:
            product *= factorial(n)
        total += (-1.0) ** k / product
    inside = factorial((j1 + m1) // 2) * factorial((j1 - m1) // 2) * factorial((j2 + m2) // 2) * factorial((j2 - m2) // 2)
    inside *= factorial((j + m) // 2) * factorial((j - m) // 2) * (j + 1)
    inside *= factorial((j1 + j2 - j) // 2) * factorial((j1 - j2 + j) // 2) * factorial((j2 - j1 + j) // 2)
    return total * sqrt(inside / factorial((j1 + j2 + j) // 2 + 1))


@cache
def bispectrum(twojmax: int, normed: bool) -> Bispectrum:
    """The tables; `normed` components are divided by 2j + 1."""
    first = np.concatenate([[0], np.cumsum([(j + 1) ** 2 for j in range(twojmax + 1)])])
    weights = np.zeros(first[-1])
    for j in range(twojmax + 1):
        for b in range(j // 2 + 1):
            for a in range(j + 1):
                weights[first[j] + b * (j + 1) + a] = 2.0 if 2 * b < j or a < b else 1.0 if a == b else 0.0
    every = [(j1, j2, j) for j1 in range(twojmax + 1) for j2 in range(j1 + 1) for j in range(j1 - j2, min(twojmax, j1 + j2) + 1, 2)]
    components = tuple(c for c in every if c[2] >= c[0])
    number = {c: k for k, c in enumerate(components)}
    z, factors, products, strengths = [], [], [], []
    for j1, j2, j in every:
        by_m = [[(a1, a2, clebsch_gordan(j1, 2 * a1 - j1, j2, 2 * a2 - j2, j, 2 * a - j)) for a1 in range(j1 + 1)
                 for a2 in (a - a1 + (j1 + j2 - j) // 2,) if 0 <= a2 <= j2] for a in range(j + 1)]
        if j >= j1:
            component, place, factor = number[j1, j2, j], 0, 1.0 if j1 != j else 3.0 if j2 == j else 2.0
        elif j >= j2:
            component, place, factor = number[j, j2, j1], 1, 2.0 if j2 == j else 1.0
        else:
            component, place, factor = number[j2, j, j1], 2, 1.0
        if j1 > j and not normed:
            factor *= (j1 + 1.0) / (j + 1.0)
        for b in range(j // 2 + 1):
            for a in range(j + 1):
                z.append((first[j] + b * (j + 1) + a, component, place, len(strengths)))
                factors.append(factor)
                for b1, b2, cb in by_m[b]:
                    for a1, a2, ca in by_m[a]:
                        products.append((first[j1] + b1 * (j1 + 1) + a1, first[j2] + b2 * (j2 + 1) + a2))
                        strengths.append(ca * cb / (j + 1.0 if normed else 1.0))
    z.append((0, 0, 0, len(strengths)))
    roots = np.array([[sqrt(p / q) if q else 0.0 for q in range(twojmax + 1)] for p in range(twojmax + 1)])
    return Bispectrum(components, first.astype(np.int64), weights, np.array(z, np.int64), np.array(factors), np.array(products, np.int32),
                      np.array(strengths), roots)
