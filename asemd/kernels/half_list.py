"""Pairs of a half list from bins, in the order in which LAMMPS on one processor has them."""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def with_images(x, reach, periodic, low, high):
    """Atoms at `x (n, 3)` and their images within `reach` of the box, in the order in which LAMMPS sends them: positions, atoms, and the
    images as numbers (m, 3) of box lengths."""
    last, room = len(x), 2 * len(x) + 1000
    y, atom, image = np.empty((room, 3)), np.empty(room, np.int64), np.zeros((room, 3), np.int64)
    for k in range(last):
        atom[k] = k
        for c in range(3):
            y[k, c] = x[k, c]
    for axis in range(3):
        if not periodic[axis]:
            continue
        first, end, length, middle = 0, last, high[axis] - low[axis], 0.5 * (low[axis] + high[axis])
        for swap in range(int(reach / length) + 1):
            for way in (1, -1):
                for k in range(first, end):
                    at = y[k, axis]
                    if not (at <= low[axis] + reach and (swap == 0 or at >= middle) if way > 0 else
                            at >= high[axis] - reach and (swap == 0 or at <= middle)):
                        continue
                    if last == room:
                        y, atom, image = np.concatenate((y, y)), np.concatenate((atom, atom)), np.concatenate((image, image))
                        room *= 2
                    atom[last] = atom[k]
                    for c in range(3):
                        y[last, c], image[last, c] = y[k, c], image[k, c]
                    y[last, axis] += way * length
                    image[last, axis] += way
                    last += 1
            first, end = end, last
    return y[:last], atom[:last], image[:last]


@njit(cache=True, nogil=True)
def bins_of(x, low, high, count):
    """(m, 3) bin of each place, of `count` between `low` and `high`; also beyond. Atoms of a lattice stand on edges of bins: numbers are
    rounded as LAMMPS rounds them."""
    out = np.empty(x.shape, np.int64)
    for k in range(len(x)):
        for c in range(3):
            scale = 1.0 / ((high[c] - low[c]) / count[c])
            if x[k, c] >= high[c]:
                out[k, c] = int((x[k, c] - high[c]) * scale) + count[c]
            elif x[k, c] >= low[c]:
                out[k, c] = min(int((x[k, c] - low[c]) * scale), count[c] - 1)
            else:
                out[k, c] = int((x[k, c] - low[c]) * scale) - 1
    return out


@njit(cache=True, nogil=True)
def spans(width, reach):
    """How many bins to go along x where the bin is `dz` and `dy` bins away, (dz, dy); -1: all of them are out of reach."""
    out = np.full((math.ceil(reach / width[2]) + 1, math.ceil(reach / width[1]) + 1), -1)
    for dz in range(out.shape[0]):
        for dy in range(out.shape[1]):
            w, v = max(dz - 1, 0) * width[2], max(dy - 1, 0) * width[1]
            left = reach * reach - w * w - v * v
            if left >= 0.0:
                out[dz, dy] = int(math.sqrt(left) / width[0]) + 1
    return out


@njit(cache=True, nogil=True)
def half_list(x, n, bins, width, reach, slot, code, pair_i, pair_j, pair_code):
    """Number of pairs of atoms 0..n-1 with what is after them in `x (m, 3)`: other atoms, and images from n on, within `reach`.

    An atom's own bin comes first, of which images count that are above it, or right of it at the same height, or where it is. Then those
    bins that are above or right of it, from the lowest on; `bins (m, 3)`, each of that `width (3,)`. Of the pairs ``slot[i]``, ``slot[j]``
    and ``code[j]`` are written; -1 where there is no room for all that are looked at for an atom.
    """
    low, count = np.empty(3, np.int64), np.empty(3, np.int64)
    for c in range(3):
        low[c] = bins[:, c].min()
        count[c] = bins[:, c].max() - low[c] + 1
    start = np.zeros(count[0] * count[1] * count[2] + 1, np.int64)
    place = np.empty(len(x), np.int64)
    for k in range(len(x)):
        place[k] = ((bins[k, 2] - low[2]) * count[1] + bins[k, 1] - low[1]) * count[0] + bins[k, 0] - low[0]
        start[place[k] + 1] += 1
    for k in range(len(start) - 1):
        start[k + 1] += start[k]
    members, y, at = np.empty((3, len(x)), np.int32), np.empty((len(x), 3)), start[:-1].copy()
    for k in range(len(x)):
        m = at[place[k]]
        at[place[k]] += 1
        members[0, m], members[1, m], members[2, m] = k, slot[k], code[k]
        for c in range(3):
            y[m, c] = x[k, c]
    found, limit, along = 0, reach * reach, spans(width, reach)
    tall, deep = along.shape[0] - 1, along.shape[1] - 1
    for i in range(n):
        before, xi, yi, zi = found, x[i, 0], x[i, 1], x[i, 2]
        bx, by, bz = bins[i, 0] - low[0], bins[i, 1] - low[1], bins[i, 2] - low[2]
        if found + start[place[i] + 1] - start[place[i]] > len(pair_i):
            return -1
        for k in range(start[place[i]], start[place[i] + 1]):
            j = members[0, k]
            u, v, w = y[k, 0] - xi, y[k, 1] - yi, y[k, 2] - zi
            after = j > i if j < n else w > 0.0 or (w == 0.0 and (v > 0.0 or (v == 0.0 and u >= 0.0)))
            pair_j[found], pair_code[found] = members[1, k], members[2, k]
            found += after and u * u + v * v + w * w <= limit
        for dz in range(min(tall, count[2] - 1 - bz) + 1):
            for dy in range(max(-deep, -by) if dz > 0 else 0, min(deep, count[1] - 1 - by) + 1):
                span = along[dz, abs(dy)]
                if span < 0:
                    continue
                # bins in line are one stretch of atoms
                line = ((bz + dz) * count[1] + by + dy) * count[0]
                first = start[line + (bx + 1 if dz == 0 and dy == 0 else max(bx - span, 0))]
                last = start[line + min(bx + span, count[0] - 1) + 1]
                if found + last - first > len(pair_i):
                    return -1
                for k in range(first, last):
                    u, v, w = y[k, 0] - xi, y[k, 1] - yi, y[k, 2] - zi
                    # written in any case and kept or not: a branch that nobody can foresee takes longer
                    pair_j[found], pair_code[found] = members[1, k], members[2, k]
                    found += u * u + v * v + w * w <= limit
        pair_i[before:found] = slot[i]
    return found


def pairs(x: np.ndarray, n: int, bins: np.ndarray, width: np.ndarray, reach: float, slot: np.ndarray, code: np.ndarray,
          guess: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The pairs as slots ``i``, ``j`` and ``code``, each (pairs,) int32; `guess`: how many there may be."""
    found = -1
    while found < 0:
        guess += guess // 8 + 1000
        out = tuple(np.empty(guess, np.int32) for _ in range(3))
        found = half_list(x, n, bins, width, reach, slot, code, *out)
    return tuple(a[:found] for a in out)
