"""The influence function of a mesh: what the wave of the potential is of the wave of the density, so that the error of forces is least."""
from __future__ import annotations

import math

import numpy as np

ORDER = 5
FOUR_PI = 12.5663706      # LAMMPS's, to its digits


def denominator(b, x, y, z):
    """The square of the sum of the squared transforms of the weights, from the sines squared of half the wave."""
    sx = sy = sz = 0.0
    for m in range(ORDER - 1, -1, -1):
        sx = b[m] + sx * x
        sy = b[m] + sy * y
        sz = b[m] + sz * z
    s = sx * sy * sz
    return s * s


def sinc_power(u):
    """(sin u / u)^(2 ORDER)."""
    if u == 0.0:
        return 1.0
    s = math.sin(u) / u
    s *= s
    p = 1.0
    for _ in range(ORDER):
        p *= s
    return p


def influence(n, numbers, turn, g, most, b):
    """The optimal influence function of the waves n (3 whole numbers), for differentiation by multiplication with the wave vector.

    `turn (3, 3)`: 2 pi times the inverse box; `most (3,)`: images along each direction.
    """
    k0 = turn[0, 0] * n[0] + turn[0, 1] * n[1] + turn[0, 2] * n[2]
    k1 = turn[1, 0] * n[0] + turn[1, 1] * n[1] + turn[1, 2] * n[2]
    k2 = turn[2, 0] * n[0] + turn[2, 1] * n[1] + turn[2, 2] * n[2]
    kk = k0 * k0 + k1 * k1 + k2 * k2
    if kk == 0.0:
        return 0.0
    a0, a1, a2 = math.pi * n[0] / numbers[0], math.pi * n[1] / numbers[1], math.pi * n[2] / numbers[2]
    total = 0.0
    for m0 in range(-most[0], most[0] + 1):
        w0 = sinc_power(a0 + math.pi * m0)
        for m1 in range(-most[1], most[1] + 1):
            w1 = w0 * sinc_power(a1 + math.pi * m1)
            for m2 in range(-most[2], most[2] + 1):
                w2 = w1 * sinc_power(a2 + math.pi * m2)
                u0, u1, u2 = n[0] + m0 * numbers[0], n[1] + m1 * numbers[1], n[2] + m2 * numbers[2]
                q0 = turn[0, 0] * u0 + turn[0, 1] * u1 + turn[0, 2] * u2
                q1 = turn[1, 0] * u0 + turn[1, 1] * u1 + turn[1, 2] * u2
                q2 = turn[2, 0] * u0 + turn[2, 1] * u1 + turn[2, 2] * u2
                qq = q0 * q0 + q1 * q1 + q2 * q2
                total += (k0 * q0 + k1 * q1 + k2 * q2) / qq * math.exp(-0.25 * qq / (g * g)) * w2
    return FOUR_PI / kk * total / denominator(b, math.sin(a0) ** 2, math.sin(a1) ** 2, math.sin(a2) ** 2)


def folded(i, n):
    """The whole number of the wave at place i of n: -n/2 ... (n-1)/2."""
    return i - n * (2 * i // n)


def opposite(i, n):
    """The same of the place that holds the opposite wave."""
    return folded((n - i) % n, n)


def make_green(first, last, numbers, turn, g, most, b, green):
    """`green` of the planes first..last-1.

    Where a number is half of an even mesh, the wave and its opposite have the same place: of the products with the wave vector only the odd
    part counts, and the function is the mean of the two.
    """
    n, o = np.empty(3, np.int64), np.empty(3, np.int64)
    for i in range(first, last):
        n[0] = folded(i, numbers[0])
        o[0] = opposite(i, numbers[0])
        for j in range(numbers[1]):
            n[1] = folded(j, numbers[1])
            o[1] = opposite(j, numbers[1])
            for k in range(numbers[2] // 2 + 1):
                n[2] = folded(k, numbers[2])
                o[2] = opposite(k, numbers[2])
                one = influence(n, numbers, turn, g, most, b)
                other = one
                if n[0] != -o[0] or n[1] != -o[1] or n[2] != -o[2]:
                    other = influence(o, numbers, turn, g, most, b)
                green[i, j, k, 0] = 0.5 * (one + other)
                for d in range(3):
                    kn = turn[d, 0] * n[0] + turn[d, 1] * n[1] + turn[d, 2] * n[2]
                    ko = turn[d, 0] * o[0] + turn[d, 1] * o[1] + turn[d, 2] * o[2]
                    green[i, j, k, 1 + d] = 0.5 * (kn * one - ko * other)
