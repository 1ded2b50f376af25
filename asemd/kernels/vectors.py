"""Items whose energy is a function of vectors, for `asemd.kernels.block`.

The vectors go from the atom CENTRE to the atoms A, B and, where there are three (THREE), C of the item (places 0 to 3); the third one
from B if CHAIN.
"""
from __future__ import annotations

from asemd.kernels.algebra import between, dot, member, minus, plus, push, put, store, times, triple

CENTRE = A = B = C = V1 = V2 = V3 = F1 = F2 = F3 = D = VALUE = VECTORS = 0
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


def gradient(b, n):
    for k in range(n):
        for c in range(VECTORS):
            store(b, F1 + 3 * c, k, times(-1.0, triple(b, D + 3 * c, k)))


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
