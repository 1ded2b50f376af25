"""Matrices of three rows. numpy's functions for any number of rows, and assignments of arrays to slices, take seconds to compile."""
from __future__ import annotations


def invert(m, out):
    """The inverse of m (3, 3) into `out`; returns the determinant."""
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for d in range(3):
            e, g = (d + 1) % 3, (d + 2) % 3
            out[d, a] = m[b, e] * m[c, g] - m[b, g] * m[c, e]
    det = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    for a in range(3):
        for d in range(3):
            out[a, d] /= det
    return det
