"""Atoms of a series of trial moves in cells of a periodic box along the axes, so that an attempt looks at those around it only.

A cell is a chain: `head` (cells,) has its first atom, `following` (atoms,) the next one of each, -1 ends it.
"""
from __future__ import annotations

import math

import numpy as np


def largest(cut2, overlap2):
    """The squared distance beyond which no atom counts."""
    most = overlap2
    for ti in range(cut2.shape[0]):
        for tj in range(cut2.shape[1]):
            most = max(most, cut2[ti, tj])
    return most


def grid(n, reach):
    """Numbers of cells (3,) that are not narrower than `reach` (fractional), not many more than `n` in all; none where an atom sees two
    images of another one."""
    counts = np.zeros(3, np.int64)
    if max(reach[0], reach[1], reach[2]) < 0.4999:
        for d in range(3):
            counts[d] = max(1, min(int(1.0 / max(reach[d], 1e-3)), int(n ** (1.0 / 3.0))))
    return counts


def cell_of(x, i, origin, inverse, counts):
    """The number of the cell of atom i."""
    c = 0
    for d in range(3):
        c = c * counts[d] + min(max(int((x[i, d] - origin[d]) * inverse[d, d] * counts[d]), 0), counts[d] - 1)
    return c


def fill(n, x, origin, inverse, counts, head, following):
    """The chains of the first `n` atoms."""
    for c in range(len(head)):
        head[c] = -1
    if len(head):
        for i in range(n):
            c = cell_of(x, i, origin, inverse, counts)
            following[i] = head[c]
            head[c] = i


def enter(i, x, origin, inverse, counts, head, following):
    """Atom i comes to where it is now."""
    if len(head):
        c = cell_of(x, i, origin, inverse, counts)
        following[i] = head[c]
        head[c] = i


def leave(i, x, origin, inverse, counts, head, following):
    """Atom i leaves where it is."""
    if len(head):
        c = cell_of(x, i, origin, inverse, counts)
        k = head[c]
        if k == i:
            head[c] = following[i]
        else:
            while following[k] != i:
                k = following[k]
            following[k] = following[i]


def around(p, x, most, reach, edges, near, r2s, origin, inverse, counts, head, following):
    """Atoms whose nearest images are closer to a place than the root of `most`, in the order of their numbers, into `near`, and their
    squared distances into `r2s`; returns how many."""
    a, b = np.empty(3, np.int64), np.empty(3, np.int64)
    for d in range(3):
        s = (p[d] - origin[d]) * inverse[d, d]
        a[d] = math.floor((s - reach[d]) * counts[d] - 1e-6)
        b[d] = min(math.floor((s + reach[d]) * counts[d] + 1e-6), a[d] + counts[d] - 1)
    px, py, pz, i0, i1, i2, l0, l1, l2 = p[0], p[1], p[2], inverse[0, 0], inverse[1, 1], inverse[2, 2], edges[0], edges[1], edges[2]
    count = 0
    for k0 in range(a[0], b[0] + 1):
        for k1 in range(a[1], b[1] + 1):
            for k2 in range(a[2], b[2] + 1):
                j = head[(k0 % counts[0] * counts[1] + k1 % counts[1]) * counts[2] + k2 % counts[2]]
                while j >= 0:
                    dx, dy, dz = px - x[j, 0], py - x[j, 1], pz - x[j, 2]
                    dx -= np.rint(dx * i0) * l0
                    dy -= np.rint(dy * i1) * l1
                    dz -= np.rint(dz * i2) * l2
                    r2 = dx * dx + dy * dy + dz * dz
                    if r2 < most:
                        m = count
                        while m > 0 and near[m - 1] > j:
                            near[m], r2s[m] = near[m - 1], r2s[m - 1]
                            m -= 1
                        near[m], r2s[m] = j, r2
                        count += 1
                    j = following[j]
    return count
