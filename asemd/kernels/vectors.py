"""Items whose energy is a function of vectors, for `asemd.kernels.block`.

The vectors go from the atom CENTRE to the atoms A, B and, where there are three (THREE), C of the item (places 0 to 3); the third one
from B if CHAIN. SIDE, if there, is what derivatives are multiplied by, see `settle`.
"""
from __future__ import annotations

from asemd.kernels.algebra import between, dot, member, minus, number, plus, push, put, store, times, triple
from asemd.kernels.volume import exact_volume, lost, volume

CENTRE = A = B = C = V1 = V2 = V3 = F1 = F2 = F3 = D = VALUE = VECTORS = SIDE = 0
THREE = CHAIN = False
closest = None


def order(style) -> list[int]:
    """Places of the centre and of the other atoms in an item of a style."""
    centre = style.centre - 1
    return [centre] + [k for k in range(3 if style.category == "angle" else 4) if k != centre]


def gather(x, items, first, n, b):
    for k in range(n):
        centre = member(items, first + k, CENTRE)
        store(b, V1, k, between(x, member(items, first + k, A), centre))
        store(b, V2, k, between(x, member(items, first + k, B), centre))
        if THREE:
            store(b, V3, k, between(x, member(items, first + k, C), member(items, first + k, B) if CHAIN else centre))


def geometry(b, n, sides):
    for k in range(n):
        value = 0.0
        for c in range(VECTORS):
            d = closest(b, V1 + 3 * c, k, sides)
            value += dot((0.0, 0.0, 0.0), d)      # not a number where a position is not
        put(b, VALUE, k, value)


def settle(b, n, first, x, items):
    """1; -1 where the vectors, which are rounded, are on the other side of a plane than the atoms; 0 for atoms in a plane."""
    for k in range(n):
        f, g, h = triple(b, V1, k), triple(b, V2, k), triple(b, V3, k)
        rough = f[0] * (g[1] * h[2] - g[2] * h[1]) + f[1] * (g[2] * h[0] - g[0] * h[2]) + f[2] * (g[0] * h[1] - g[1] * h[0])
        put(b, SIDE, k, 1.0)
        if rough * rough <= 1e-29 * dot(f, f) * dot(g, g) * dot(h, h):
            i, j, l = member(items, first + k, A), member(items, first + k, B), member(items, first + k, C)
            m = member(items, first + k, CENTRE)
            u, v, w = lost(f, x, i, m), lost(g, x, j, m), lost(h, x, l, m)
            mine, side = volume(f[0], f[1], f[2], g[0], g[1], g[2], h[0], h[1], h[2]), exact_volume(f, g, h, u, v, w)
            put(b, SIDE, k, 0.0 if side == 0.0 else 1.0 if (side > 0.0) == (mine >= 0.0) else -1.0)


def gradient(b, n):
    for k in range(n):
        w = -1.0
        if SIDE:
            w = -number(b, SIDE, k)
        for c in range(VECTORS):
            store(b, F1 + 3 * c, k, times(w, triple(b, D + 3 * c, k)))


def scatter(out, items, first, n, b):
    for k in range(n):
        f, g = triple(b, F1, k), triple(b, F2, k)
        centre = plus(f, g)
        if THREE:
            h = triple(b, F3, k)
            push(out, member(items, first + k, C), h)
            if CHAIN:
                g = minus(g, h)
            else:
                centre = plus(centre, h)
        push(out, member(items, first + k, A), f)
        push(out, member(items, first + k, B), g)
        push(out, member(items, first + k, CENTRE), times(-1.0, centre))
