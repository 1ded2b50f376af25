"""What two meshes half a spacing apart take, whose mean field is used: images of waves with an odd number cancel between them.

U. Neelov, C. Holm, J. Chem. Phys. 132, 234103 (2010).
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.generate import Builder
from asemd.kernels.influence import folded
from asemd.kernels.pppm_ad import one_direction, power

ORDER = 5
AD = False


def denominator(b, x, y, z):
    """The mean of the squares of the sums over images of the squared transforms of the weights, all with plus and with alternate signs.

    `b (2 ORDER,)`: coefficients in powers of the sine squared, then in even powers of the cosine.
    """
    sx = sy = sz = tx = ty = tz = 0.0
    for m in range(ORDER - 1, -1, -1):
        sx = b[m] + sx * x
        sy = b[m] + sy * y
        sz = b[m] + sz * z
        tx = b[ORDER + m] + tx * (1.0 - x)
        ty = b[ORDER + m] + ty * (1.0 - y)
        tz = b[ORDER + m] + tz * (1.0 - z)
    s, t = sx * sy * sz, tx * ty * tz
    return 0.5 * (s * s + (1.0 - x) * (1.0 - y) * (1.0 - z) * t * t)


def quality(numbers, lengths, g, aliases):
    """The sum over the mesh that the square of the error of forces is proportional to.

    Images with even and with odd numbers count each for themselves, as LAMMPS has it (for coarse meshes it adds yet other parts of them).
    """
    a, b, c = np.empty((3, numbers[0], 5)), np.empty((3, numbers[1], 5)), np.empty((3, numbers[2], 5))
    one_direction(numbers[0], lengths[0], g, 2, a)
    one_direction(numbers[1], lengths[1], g, 2, b)
    one_direction(numbers[2], lengths[2], g, 2, c)
    total = 0.0
    four_pi = 4.0 * math.pi
    for i in range(numbers[0]):
        x = math.sin(0.5 * a[0, i, 2] * lengths[0] / numbers[0]) ** 2
        for j in range(numbers[1]):
            y = math.sin(0.5 * b[0, j, 2] * lengths[1] / numbers[1]) ** 2
            for k in range(numbers[2]):
                if i == 0 and j == 0 and k == 0:
                    continue
                k0, k1, k2 = a[0, i, 2], b[0, j, 2], c[0, k, 2]
                kk = k0 * k0 + k1 * k1 + k2 * k2
                s1, even, odd, s3, s4, s5, s6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for m0 in range(5):
                    for m1 in range(5):
                        for m2 in range(5):
                            alternate = (m0 + m1 + m2) % 2 == 1
                            sign = -1.0 if alternate else 1.0
                            qq = a[0, i, m0] ** 2 + b[0, j, m1] ** 2 + c[0, k, m2] ** 2
                            u1 = a[1, i, m0] * b[1, j, m1] * c[1, k, m2]
                            u2 = a[2, i, m0] * b[2, j, m1] * c[2, k, m2]
                            s1 += u1 * u1 / qq * four_pi * four_pi
                            part = u1 * u2 * four_pi
                            if not AD:
                                part *= (k0 * a[0, i, m0] + k1 * b[0, j, m1] + k2 * c[0, k, m2]) / qq
                            odd += part if alternate else 0.0
                            even += 0.0 if alternate else part
                            s3 += u2
                            s4 += qq * u2
                            s5 += sign * u2
                            s6 += sign * qq * u2
                if AD:
                    total += s1 - (even * even + odd * odd) / (0.5 * (s3 * s4 + s5 * s6))
                else:
                    z = math.sin(0.5 * k2 * lengths[2] / numbers[2]) ** 2
                    total += s1 - (even * even + odd * odd) / (kk * denominator(aliases, x, y, z))
    return total


@cache
def quality_of(order: int, ad: bool):
    """`quality` for weights of that order, differentiated if `ad`."""
    b = Builder(f"error of two meshes, order {order}")
    b.constant("ORDER", order)
    b.constant("AD", ad)
    for f in (denominator, folded, power, one_direction, quality):
        b.function(f, fast=True)
    return b.build().quality
