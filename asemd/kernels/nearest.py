"""Whether atoms are near a place, by closest images."""
from __future__ import annotations

from functools import cache


def occupied(at, x, near2, inverse, cell, periodic):
    """Whether an atom at x (3, n) is nearer to a place of `at` (m, 3) than the root of `near2`."""
    aligned = True
    for a in range(3):
        for b in range(3):
            aligned = aligned and (a == b or cell[a, b] == 0.0)
    for k in range(at.shape[0]):
        for j in range(x.shape[1]):
            if aligned:
                r2 = 0.0
                for a in range(3):
                    d = at[k, a] - x[a, j]
                    if periodic[a]:
                        d -= round(d * inverse[a, a]) * cell[a, a]
                    r2 += d * d
                    if r2 >= near2:
                        break
            else:
                d0, d1, d2 = at[k, 0] - x[0, j], at[k, 1] - x[1, j], at[k, 2] - x[2, j]
                for a in range(3):
                    if periodic[a]:
                        n = round(d0 * inverse[0, a] + d1 * inverse[1, a] + d2 * inverse[2, a])
                        d0 -= n * cell[a, 0]
                        d1 -= n * cell[a, 1]
                        d2 -= n * cell[a, 2]
                r2 = d0 * d0 + d1 * d1 + d2 * d2
            if r2 < near2:
                return True
    return False


@cache
def kernel():
    """The compiled function."""
    from asemd.kernels.generate import Builder
    b = Builder("occupied places")
    b.function(occupied)
    return b.build().occupied
