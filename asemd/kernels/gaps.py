"""Empty stretches of a box that lists of neighbours leave out, so that their cells are small where atoms are.

Two ordinary functions for the generated modules of `asemd.kernels.cluster`, in which SQUEEZED says whether anything is left out.
"""
from __future__ import annotations

import numpy as np

SQUEEZED = True


def find_gaps(x, row, ns, origin, inverse, reach, low, high, places):
    """Where stretches without atoms can be left out between atoms that do not reach each other, for `squeeze`.

    Parameters
    ----------
    reach : (3,)
        In fractional coordinates.
    low, high : (m,)
        Work space: the atoms that are furthest to both sides in each of m slabs across a direction.
    places : (3, m+2)
        Becomes for each direction how many slabs there are, one over the length that is left, and what is left out before each slab.
    """
    m = len(low)
    for a in range(3):
        i0, i1, i2 = inverse[0, a], inverse[1, a], inverse[2, a]
        for k in range(m):
            low[k] = np.inf
            high[k] = -np.inf
        for i in range(ns):
            if row[i] >= 0:
                s = (x[0, i] - origin[0]) * i0 + (x[1, i] - origin[1]) * i1 + (x[2, i] - origin[2]) * i2
                k = min(max(int(s * m), 0), m - 1)
                low[k] = min(low[k], s)
                high[k] = max(high[k], s)
        first, last, out = np.inf, -np.inf, 0.0
        for k in range(m):
            if low[k] <= high[k]:
                if first < np.inf and low[k] - last > reach[a]:
                    out += low[k] - last - reach[a]
                first = min(first, low[k])
                last = high[k]
            places[a, 2 + k] = out
        length = 1.0 - out
        if first < np.inf and first + 1.0 - last > reach[a]:      # across or at the faces, too
            length = last - first - out + reach[a]
            for k in range(m):
                places[a, 2 + k] += first
        places[a, 0] = m
        places[a, 1] = 1.0 / length


def squeeze(s, places, a):
    """A fractional coordinate along direction `a` without the empty stretches that `find_gaps` found: whoever is within reach stays so."""
    if SQUEEZED:
        m = int(places[a, 0])
        return (s - places[a, 2 + min(max(int(s * m), 0), m - 1)]) * places[a, 1]
    return s
