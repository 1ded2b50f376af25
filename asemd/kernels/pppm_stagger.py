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
from asemd.kernels.whole_power import whole_power

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


def rounded(b, x, y, z, cx, cy, cz):
    """`denominator` in LAMMPS's order of operations, from the sines squared and the cosines."""
    sx = sy = sz = tx = ty = tz = 0.0
    for m in range(ORDER - 1, -1, -1):
        sx = b[m] + sx * x
        sy = b[m] + sy * y
        sz = b[m] + sz * z
    px, py, pz = cx, cy, cz
    for m in range(ORDER):
        tx += b[ORDER + m] * px
        ty += b[ORDER + m] * py
        tz += b[ORDER + m] * pz
        px *= cx * cx
        py *= cy * cy
        pz *= cz * cz
    s, t = sx * sy * sz, tx * ty * tz
    return 0.5 * (s * s + t * t)


def quality(numbers, lengths, g, aliases):
    """The sum over the mesh that the square of the error of forces is proportional to, as LAMMPS estimates it, in its order of operations.

    Each image of a wave counts for itself, as if those of even and of odd number did not add up within each of the meshes.
    """
    a, b, c = np.empty((3, numbers[0], 5)), np.empty((3, numbers[1], 5)), np.empty((3, numbers[2], 5))
    one_direction(numbers[0], lengths[0], g, 2, a)
    one_direction(numbers[1], lengths[1], g, 2, b)
    one_direction(numbers[2], lengths[2], g, 2, c)
    total, four_pi = 0.0, 4.0 * math.pi
    for k in range(numbers[2]):
        half = 0.5 * c[0, k, 2] * lengths[2] / numbers[2]
        z, cz = math.sin(half), math.cos(half)
        for j in range(numbers[1]):
            half = 0.5 * b[0, j, 2] * lengths[1] / numbers[1]
            y, cy = math.sin(half), math.cos(half)
            for i in range(numbers[0]):
                if i == 0 and j == 0 and k == 0:
                    continue
                half = 0.5 * a[0, i, 2] * lengths[0] / numbers[0]
                x, cx = math.sin(half), math.cos(half)
                k0, k1, k2 = a[0, i, 2], b[0, j, 2], c[0, k, 2]
                first = four_pi / (k0 * k0 + k1 * k1 + k2 * k2)
                s1, s2, s3, s4, s5, s6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for m0 in range(5):
                    for m1 in range(5):
                        for m2 in range(5):
                            q0, q1, q2 = a[0, i, m0], b[0, j, m1], c[0, k, m2]
                            qq = q0 * q0 + q1 * q1 + q2 * q2
                            u1 = a[1, i, m0] * b[1, j, m1] * c[1, k, m2]
                            u2 = a[2, i, m0] * b[2, j, m1] * c[2, k, m2]
                            if AD:
                                sign = -1.0 if (m0 + m1 + m2) % 2 == 1 else 1.0
                                s1 += u1 * u1 / qq * four_pi * four_pi
                                s2 += u1 * u1 * u2 * u2 * four_pi * four_pi
                                s3 += u2
                                s4 += qq * u2
                                s5 += u2 * sign
                                s6 += qq * u2 * sign
                            else:
                                part = first * u1 * u2 * (k0 * q0 + k1 * q1 + k2 * q2)
                                s1 += u1 * u1 * four_pi * four_pi / qq
                                s2 += part * part / qq
                total += s1 - s2 / (0.5 * (s3 * s4 + s5 * s6) if AD else rounded(aliases, x * x, y * y, z * z, cx, cy, cz))
    return total


@cache
def quality_of(order: int, ad: bool):
    """`quality` for weights of that order, differentiated if `ad`."""
    b = Builder(f"error of two meshes, order {order}")
    b.constant("ORDER", order)
    b.constant("AD", ad)
    for f in (rounded, folded, whole_power, power, one_direction, quality):
        b.function(f)
    return b.build().quality
