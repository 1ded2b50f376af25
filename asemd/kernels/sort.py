"""Sorting atoms into slots, by several threads.

Atoms stand in columns along the third cell vector, ordered along it by fine cells; `CLUSTER` consecutive ones form a cluster; empty
slots pad the last cluster of a column, and the last one before an empty stretch: kernels in single precision take positions from the first
atom of a cluster, and lose digits where the others are far.

It is a counting sort: each thread counts the atoms of its slots (`bin_atoms`), then one gives the cells their places (`assign`), then each
moves its atoms (`move`). The order does not depend on the number of threads. Ordinary Python functions, which `asemd.neighbor` pastes and
compiles; `CLUSTER` and `ORTHO` are constants of the generated module.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.cluster import CLUSTER
from asemd.kernels.columns import column
from asemd.kernels.gaps import squeeze

ORTHO = True


def wrap(x, image, row, i0, i1, origin, vectors, inverse, periodic):
    """Fold slots i0..i1-1 into the cell, counting images; returns the first slot that is not finite, or -1."""
    for i in range(i0, i1):
        r = row[i]
        if r < 0:
            continue
        if not (abs(x[0, i]) + abs(x[1, i]) + abs(x[2, i]) < np.inf):
            return i
        for a in range(2, -1, -1):
            if not periodic[a]:
                continue
            if ORTHO:
                d = x[a, i] - origin[a]
                if d < 0.0 or x[a, i] >= origin[a] + vectors[a, a]:
                    n = math.floor(d / vectors[a, a])
                    x[a, i] -= n * vectors[a, a]
                    image[r, a] += int(n)
                    if x[a, i] >= origin[a] + vectors[a, a]:     # rounding at the upper face
                        x[a, i] = origin[a]
                        image[r, a] += 1
            else:
                s = ((x[0, i] - origin[0]) * inverse[0, a] + (x[1, i] - origin[1]) * inverse[1, a]
                     + (x[2, i] - origin[2]) * inverse[2, a])
                n = math.floor(s)
                if n != 0.0 and s - n >= 1.0:       # rounding below the lower face
                    n += 1
                if n != 0.0:
                    for d in range(3):
                        x[d, i] -= n * vectors[a, d]
                    image[r, a] += int(n)
    return -1


def bin_atoms(x, v, row, i0, i1, origin, inverse, nx, ny, nz, x2, v2, row2, counts, key, places):
    """The number of atoms of slots i0..i1-1 in each cell into `counts (nx ny nz,)`, the cell of each into `key`; and a copy of them."""
    for c in range(nx * ny * nz):
        counts[c] = 0
    for i in range(i0, i1):
        at = np.uint64(i)
        r = row[at]
        row2[at] = r
        for d in range(3):
            x2[d, at] = x[d, at]
            v2[d, at] = v[d, at]
        if r < 0:
            continue
        dx = x[0, at] - origin[0]
        dy = x[1, at] - origin[1]
        dz = x[2, at] - origin[2]
        s0 = dx * inverse[0, 0] + dy * inverse[1, 0] + dz * inverse[2, 0]
        s1 = dx * inverse[0, 1] + dy * inverse[1, 1] + dz * inverse[2, 1]
        s2 = dx * inverse[0, 2] + dy * inverse[1, 2] + dz * inverse[2, 2]
        a = min(max(int(squeeze(s0, places, 0) * nx), 0), nx - 1)
        b = min(max(int(squeeze(s1, places, 1) * ny), 0), ny - 1)
        c = min(max(int(squeeze(s2, places, 2) * nz), 0), nz - 1)
        cell = column(a, b, nx, ny) * nz + c
        key[at] = cell
        counts[np.uint64(cell)] += 1


def leave_empty(x, v, row, i0, i1, far, far_step):
    """Empty slots stand at `far` plus steps, at rest."""
    for k in range(i0, i1):
        row[k] = -1
        for d in range(3):
            x[d, k] = far[d]
            v[d, k] = 0.0
        x[0, k] += (k % CLUSTER) * far_step


def assign(counts, x, v, row, ns, nx, ny, nz, x2, v2, row2, cell_start, column_start, column_of, far, far_step, void):
    """Where the cells begin (`cell_start (nx ny, nz + 1)`), and in `counts (nth, ...)` where the atoms of each thread go.

    A cluster ends before more than `void` empty cells. Returns the new number of slots, or minus that if there is no room for so many; then
    the atoms are where they were.
    """
    ncol, room, p = nx * ny, row.shape[0] - CLUSTER, 0
    for c in range(ncol):
        column_start[c] = p
        last, cell = nz, c * nz
        for z in range(nz):
            here = 0
            for t in range(counts.shape[0]):
                here += counts[t, np.uint64(cell + z)]
            if here > 0:
                if z - last > void + 1 and p % CLUSTER != 0:
                    full = p + (-p) % CLUSTER
                    leave_empty(x, v, row, p, min(full, room), far, far_step)
                    p = full
                last = z
            cell_start[c, z] = p
            for t in range(counts.shape[0]):
                mine = counts[t, np.uint64(cell + z)]
                counts[t, np.uint64(cell + z)] = p
                p += mine
        cell_start[c, nz] = p
        full = p + (-p) % CLUSTER
        leave_empty(x, v, row, p, min(full, room), far, far_step)
        p = full
        for k in range(column_start[c] // CLUSTER, min(p, room) // CLUSTER):
            column_of[k] = c
    column_start[ncol] = p
    if p > room:
        for i in range(ns):
            row[i] = row2[i]
            for d in range(3):
                x[d, i] = x2[d, i]
                v[d, i] = v2[d, i]
        return -p - CLUSTER
    leave_empty(x, v, row, p, p + CLUSTER, far, far_step)      # one empty cluster behind: the target of padding entries
    return p


def move(i0, i1, x2, v2, row2, key, starts, x, v, row):
    """The atoms that were in slots i0..i1-1 to their new slots; `starts` is the row of `counts` of this thread."""
    for i in range(i0, i1):
        r = row2[i]
        if r < 0:
            continue
        at = np.uint64(key[i])
        k = np.uint64(starts[at])
        starts[at] += 1
        for d in range(3):
            x[d, k] = x2[d, np.uint64(i)]
            v[d, k] = v2[d, np.uint64(i)]
        row[k] = r
