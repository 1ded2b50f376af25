"""What differentiating the weights instead of the waves takes (``kspace_modify diff ad``), for boxes along the axes.

The force on a charge by itself does not vanish then; its first two harmonics are taken off (V. Ballenegger, J. J. Cerda, C. Holm,
J. Chem. Theory Comput. 8, 936 (2012)).
"""
from __future__ import annotations

import math
from functools import cache

import numpy as np

from asemd.kernels.generate import Builder
from asemd.kernels.influence import denominator, folded
from asemd.kernels.whole_power import whole_power

ORDER = 5
WIDE = 8


def power(u, n):
    """(sin u / u)^n, by squares, so that it is rounded as in LAMMPS."""
    return whole_power(math.sin(u) / u, n) if u != 0.0 else 1.0


def one_direction(n, length, g, images, out):
    """``out (3, n, 2 images + 1)``: waves of an edge and their images, their Gaussians, their weights to the power 2 ORDER."""
    for i in range(n):
        for m in range(2 * images + 1):
            q = 2.0 * math.pi / length * (folded(i, n) + n * (m - images))
            r = q / g
            out[0, i, m], out[1, i, m], out[2, i, m] = q, math.exp(-0.25 * (r * r)), power(0.5 * q * length / n, 2 * ORDER)


def quality(numbers, lengths, g):
    """The sum over the mesh that the square of the error of forces is proportional to, for the best influence function.

    Differences of nearly equal numbers: it is computed in LAMMPS's order, without shortcuts, because the search for the splitting parameter
    takes differences of it and would end elsewhere.
    """
    a, b, c = np.empty((3, numbers[0], 5)), np.empty((3, numbers[1], 5)), np.empty((3, numbers[2], 5))
    one_direction(numbers[0], lengths[0], g, 2, a)
    one_direction(numbers[1], lengths[1], g, 2, b)
    one_direction(numbers[2], lengths[2], g, 2, c)
    total = 0.0
    four_pi = 4.0 * math.pi
    for k in range(numbers[2]):
        for j in range(numbers[1]):
            for i in range(numbers[0]):
                if i == 0 and j == 0 and k == 0:
                    continue
                s1, s2, s3, s4 = 0.0, 0.0, 0.0, 0.0
                for m0 in range(5):
                    for m1 in range(5):
                        for m2 in range(5):
                            qq = a[0, i, m0] * a[0, i, m0] + b[0, j, m1] * b[0, j, m1] + c[0, k, m2] * c[0, k, m2]
                            u1 = a[1, i, m0] * b[1, j, m1] * c[1, k, m2]
                            u2 = a[2, i, m0] * b[2, j, m1] * c[2, k, m2]
                            s1 += u1 * u1 / qq * four_pi * four_pi
                            s2 += u1 * u2 * four_pi
                            s3 += u2
                            s4 += qq * u2
                total += s1 - s2 * s2 / (s3 * s4)
    return total


def make_green_ad(first, last, numbers, lengths, g, b, green):
    """The influence function of the planes first..last-1."""
    for i in range(first, last):
        n0 = folded(i, numbers[0])
        q0, a0 = 2.0 * math.pi / lengths[0] * n0, math.pi * n0 / numbers[0]
        for j in range(numbers[1]):
            n1 = folded(j, numbers[1])
            q1, a1 = 2.0 * math.pi / lengths[1] * n1, math.pi * n1 / numbers[1]
            for k in range(numbers[2] // 2 + 1):
                n2 = folded(k, numbers[2])
                q2, a2 = 2.0 * math.pi / lengths[2] * n2, math.pi * n2 / numbers[2]
                qq = q0 * q0 + q1 * q1 + q2 * q2
                value = 0.0
                if qq != 0.0:
                    top = 4.0 * math.pi / qq * math.exp(-0.25 * qq / (g * g))
                    w = power(a0, 2 * ORDER) * power(a1, 2 * ORDER) * power(a2, 2 * ORDER)
                    value = top * w / denominator(b, math.sin(a0) ** 2, math.sin(a1) ** 2, math.sin(a2) ** 2)
                green[i, j, k, 0] = value


def overlaps(n, out):
    """``out (3, n)``: sums over images of the product of the weights with themselves, and with those one and two meshes farther."""
    for i in range(n):
        u = math.pi * folded(i, n) / n
        for s in range(3):
            total = 0.0
            for m in range(-2, 3):
                total += power(u + math.pi * m, ORDER) * power(u + math.pi * (m + s), ORDER)
            out[s, i] = total


def own_force(numbers, lengths, volume, green, own):
    """``own (3, 2)``: amplitudes of the force on a charge by itself."""
    a, b, c = np.empty((3, numbers[0])), np.empty((3, numbers[1])), np.empty((3, numbers[2]))
    overlaps(numbers[0], a)
    overlaps(numbers[1], b)
    overlaps(numbers[2], c)
    own[:] = 0.0
    nz = numbers[2]
    for i in range(numbers[0]):
        for j in range(numbers[1]):
            for k in range(nz // 2 + 1):
                w, o = green[i, j, k, 0], nz - k      # the sums over images are cut off: those of the opposite wave are others
                twice = k > 0 and k != o
                same = c[0, k] + (c[0, o] if twice else 0.0)
                for s in range(2):
                    own[0, s] += w * a[s + 1, i] * b[0, j] * same
                    own[1, s] += w * a[0, i] * b[s + 1, j] * same
                    own[2, s] += w * a[0, i] * b[0, j] * (c[s + 1, k] + (c[s + 1, o] if twice else 0.0))
    for d in range(3):
        for s in range(2):
            own[d, s] *= math.pi / volume * numbers[d] / lengths[d] * (s + 1)


def gather_ad(x, f, q, least, lo, hi, numbers, lengths, scale, own, wrap, base, weight, packed, flat):
    """Forces on slots lo..hi-1 from the potential on the mesh."""
    for i in range(lo, hi):
        if abs(q[i]) <= least:
            continue
        w, e0, e1, e2 = weight[i], 0.0, 0.0, 0.0
        b2 = base[i, 2]
        for l in range(ORDER):
            b0 = wrap[0, base[i, 0] + l]
            for m in range(ORDER):
                row = packed[b0, wrap[1, base[i, 1] + m], b2:b2 + ORDER]
                u, du = 0.0, 0.0
                for n in range(ORDER):
                    u += w[2 * WIDE + n] * row[n]
                    du += w[5 * WIDE + n] * row[n]
                e0 += w[3 * WIDE + l] * w[WIDE + m] * u
                e1 += w[l] * w[4 * WIDE + m] * u
                e2 += w[l] * w[WIDE + m] * du
        for d in range(3):
            if d == 2 and flat:
                continue
            inverse = numbers[d] / lengths[d]
            s = 2.0 * math.pi * x[d, i] * inverse
            back = (own[d, 0] * math.sin(s) + own[d, 1] * math.sin(2.0 * s)) * 2.0 * q[i] * q[i]
            f[d, i] += scale * ((e0 if d == 0 else e1 if d == 1 else e2) * inverse * q[i] - back)


FUNCTIONS = (whole_power, power, make_green_ad, overlaps, own_force, gather_ad)


@cache
def quality_of(order: int):
    """`quality` for weights of that order."""
    b = Builder(f"error of differentiated weights, order {order}")
    b.constant("ORDER", order)
    for f in (folded, whole_power, power, one_direction, quality):
        b.function(f)
    return b.build().quality
