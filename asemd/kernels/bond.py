"""Bonds for `asemd.kernels.block`: d = x1 - x2, r = |d|."""
from __future__ import annotations

import math

from asemd.kernels.algebra import between, dot, member, number, push, put, store, times, triple

V1 = F1 = R = D = 0
closest = None


def gather(x, items, first, n, b):
    for k in range(n):
        store(b, V1, k, between(x, member(items, first + k, 0), member(items, first + k, 1)))


def geometry(b, n, sides):
    for k in range(n):
        d = closest(b, V1, k, sides)
        put(b, R, k, math.sqrt(dot(d, d)))      # 0 is for the style to judge


def gradient(b, n):
    for k in range(n):
        r = number(b, R, k)
        w = -number(b, D, k) / r
        w = w if r > 0.0 else 0.0        # at r = 0 the force has no direction
        store(b, F1, k, times(w, triple(b, V1, k)))


def scatter(out, items, first, n, b):
    for k in range(n):
        f = triple(b, F1, k)
        push(out, member(items, first + k, 0), f)
        push(out, member(items, first + k, 1), times(-1.0, f))
