"""Angles for `asemd.kernels.block`: a = x1 - x2, b = x3 - x2. R12, R32, R13 are the rows of the distances that the style takes, or 0.

theta = atan2(|a x b|, a . b) and its gradient (a x n) / (a^2 |n|), n = a x b, keep all digits from 0 to 180 degrees.
"""
from __future__ import annotations

import math

from asemd.kernels.algebra import between, cross, dot, member, minus, number, plus, push, put, store, times, triple
from asemd.kernels.vector_math import vector_atan2

V1 = V2 = F1 = F2 = THETA = R12 = R32 = R13 = D = D12 = D32 = D13 = SHAPE = NORMAL = 0
closest = None


def gather(x, items, first, n, b):
    for k in range(n):
        j = member(items, first + k, 1)
        store(b, V1, k, between(x, member(items, first + k, 0), j))
        store(b, V2, k, between(x, member(items, first + k, 2), j))


def geometry(b, n, sides):
    for k in range(n):
        a = closest(b, V1, k, sides)
        c = closest(b, V2, k, sides)
        normal = cross(a, c)
        aa, cc, size = dot(a, a), dot(c, c), math.sqrt(dot(normal, normal))
        put(b, NORMAL, k, size)
        put(b, THETA, k, vector_atan2(size, dot(a, c)))
        put(b, SHAPE, k, aa if aa < cc else cc)      # 0: two atoms at one place, the force diverges
        if R12:
            put(b, R12, k, math.sqrt(aa))
        if R32:
            put(b, R32, k, math.sqrt(cc))
        if R13:
            e = minus(a, c)
            put(b, R13, k, math.sqrt(dot(e, e)))


def gradient(b, n):
    for k in range(n):
        a, c, size = triple(b, V1, k), triple(b, V2, k), number(b, NORMAL, k)
        normal, slope = cross(a, c), -number(b, D, k)
        u, w = slope / (dot(a, a) * size), slope / (dot(c, c) * size)
        u, w = u if size > 0.0 else 0.0, w if size > 0.0 else 0.0      # on a straight line the force has no direction
        f, g = times(u, cross(a, normal)), times(w, cross(normal, c))
        if R12:
            f = plus(f, times(-number(b, D12, k) / number(b, R12, k), a))
        if R32:
            g = plus(g, times(-number(b, D32, k) / number(b, R32, k), c))
        if R13:
            r13 = number(b, R13, k)
            w = -number(b, D13, k) / r13
            e = times(w if r13 > 0.0 else 0.0, minus(a, c))
            f, g = plus(f, e), minus(g, e)
        store(b, F1, k, f)
        store(b, F2, k, g)


def scatter(out, items, first, n, b):
    for k in range(n):
        f, g = triple(b, F1, k), triple(b, F2, k)
        push(out, member(items, first + k, 0), f)
        push(out, member(items, first + k, 1), times(-1.0, plus(f, g)))
        push(out, member(items, first + k, 2), g)
