"""Torsion angles for `asemd.kernels.block` (dihedrals, and impropers in phi or chi). R12, R23, R34, THETA1, THETA2 are the rows of the
lengths and angles that the style takes besides, or 0. SIDE tells on which side of the plane of the first three atoms the last one is:
positive, negative, 0 in it, not a number where three atoms are on a line and phi is not defined. FLAT is what SIDE must exceed for phi to
keep its digits; `settle` computes it anew for the others, from the positions, whose differences are rounded.

With f = x1 - x2, g = x2 - x3, h = x4 - x3, a = f x g, c = h x g the sine is (c x a) . g / |g| and the gradients are multiples of a / a^2
and c / c^2, so that no sine is divided by. Source: Blondel and Karplus, J. Comput. Chem. 17, 1132 (1996).
"""
from __future__ import annotations

import math

from asemd.kernels.algebra import between, cross, dot, member, minus, number, plus, push, put, store, times, triple
from asemd.kernels.vector_math import vector_atan2
from asemd.kernels.volume import exact_volume, lost

V1 = V2 = V3 = F1 = F2 = F3 = PHI = R12 = R23 = R34 = THETA1 = THETA2 = 0
D = D12 = D23 = D34 = DTHETA1 = DTHETA2 = SHAPE = SIDE = FLAT = 0
closest = None


def gather(x, items, first, n, b):
    for k in range(n):
        j, l = member(items, first + k, 1), member(items, first + k, 2)
        store(b, V1, k, between(x, member(items, first + k, 0), j))
        store(b, V2, k, between(x, j, l))
        store(b, V3, k, between(x, member(items, first + k, 3), l))


def geometry(b, n, sides):
    for k in range(n):
        f = closest(b, V1, k, sides)
        g = closest(b, V2, k, sides)
        h = closest(b, V3, k, sides)
        a, c = cross(f, g), cross(h, g)
        ff, gg, hh, aa, cc = dot(f, f), dot(g, g), dot(h, h), dot(a, a), dot(c, c)
        bent = aa != 0.0 and cc != 0.0                           # else three atoms are on a line, and 90 degrees count
        sine = dot(cross(c, a), g) / math.sqrt(gg) + 0.0         # never -0.0: trans is +pi
        phi = vector_atan2(sine, dot(a, c))
        put(b, PHI, k, phi if bent else 0.5 * math.pi)
        put(b, SIDE, k, sine if bent else math.nan)
        put(b, FLAT, k, 1.3e-26 * gg * (ff * cc + hh * aa))      # (2^-53 1000)^2
        least = ff if ff < gg else gg
        put(b, SHAPE, k, least if least < hh else hh)      # 0: two atoms at one place, the force diverges
        if R12:
            put(b, R12, k, math.sqrt(ff))
        if R23:
            put(b, R23, k, math.sqrt(gg))
        if R34:
            put(b, R34, k, math.sqrt(hh))
        if THETA1:
            put(b, THETA1, k, vector_atan2(math.sqrt(aa), -dot(f, g)))
        if THETA2:
            put(b, THETA2, k, vector_atan2(math.sqrt(cc), dot(g, h)))


def settle(b, n, first, x, items):
    """SIDE and PHI of the items that are flat, to the last digit."""
    count = 0
    for k in range(n):
        count += number(b, SIDE, k) * number(b, SIDE, k) <= number(b, FLAT, k)
    if count > 0:
        for k in range(n):
            f, g, h = triple(b, V1, k), triple(b, V2, k), triple(b, V3, k)
            flat = number(b, SIDE, k) * number(b, SIDE, k) <= number(b, FLAT, k)
            for d in range(3):
                flat = flat and abs(f[d]) + abs(g[d]) + abs(h[d]) > 0.0      # else in a plane of the axes
            if flat:
                i, j = member(items, first + k, 0), member(items, first + k, 1)
                l, m = member(items, first + k, 2), member(items, first + k, 3)
                u, v, w = lost(f, x, i, j), lost(g, x, j, l), lost(h, x, m, l)
                a, c = cross(f, g), cross(h, g)
                side = exact_volume(f, g, h, u, v, w) * math.sqrt(dot(g, g))
                put(b, SIDE, k, side)
                put(b, PHI, k, math.atan2(side + 0.0, dot(a, c)))


def gradient(b, n):
    for k in range(n):
        f, g, h = triple(b, V1, k), triple(b, V2, k), triple(b, V3, k)
        a, c = cross(f, g), cross(h, g)
        ff, gg, hh, aa, cc, slope = dot(f, f), dot(g, g), dot(h, h), dot(a, a), dot(c, c), number(b, D, k)
        length, bent = math.sqrt(gg), aa != 0.0 and cc != 0.0
        u, w = slope / aa, slope / cc
        u, w = u if bent else 0.0, w if bent else 0.0            # with three atoms on a line the force has no direction
        p, q = dot(f, g) / length * u, dot(h, g) / length * w
        f1, f2, f3 = times(u * length, a), minus(times(q, c), times(p, a)), times(-w * length, c)
        if THETA1:                                               # the angle of f with -g; on a straight line there is no direction
            w = number(b, DTHETA1, k) / math.sqrt(aa)
            w = w if aa > 0.0 else 0.0
            f1, f2 = plus(f1, times(w / ff, cross(f, a))), minus(f2, times(w / gg, cross(g, a)))
        if THETA2:                                               # the angle of g with h
            w = number(b, DTHETA2, k) / math.sqrt(cc)
            w = w if cc > 0.0 else 0.0
            f2, f3 = plus(f2, times(w / gg, cross(g, c))), minus(f3, times(w / hh, cross(h, c)))
        if R12:
            f1 = plus(f1, times(-number(b, D12, k) / number(b, R12, k), f))
        if R23:
            f2 = plus(f2, times(-number(b, D23, k) / number(b, R23, k), g))
        if R34:
            f3 = plus(f3, times(-number(b, D34, k) / number(b, R34, k), h))
        store(b, F1, k, f1)
        store(b, F2, k, f2)
        store(b, F3, k, f3)


def scatter(out, items, first, n, b):
    for k in range(n):
        f, g, h = triple(b, F1, k), triple(b, F2, k), triple(b, F3, k)
        push(out, member(items, first + k, 0), f)
        push(out, member(items, first + k, 1), minus(g, f))
        push(out, member(items, first + k, 2), times(-1.0, plus(g, h)))
        push(out, member(items, first + k, 3), h)
