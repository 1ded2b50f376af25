"""Loops of observers over pairs of atoms: separations, histograms, the neighbours of each atom."""
from __future__ import annotations

import numpy as np

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def separations(x, row, i, j, code, shifts, first, second, d, r2):
    """Slots i, j of pairs and images ``code >> 2``: rows into `first` and `second`, vectors from j to i into `d (m, 3)`, squares `r2`."""
    for m in range(len(i)):
        a, b, s = i[m], j[m], code[m] >> 2
        u = x[0, a] - (x[0, b] + shifts[s, 0])
        v = x[1, a] - (x[1, b] + shifts[s, 1])
        w = x[2, a] - (x[2, b] + shifts[s, 2])
        first[m], second[m] = row[a], row[b]
        d[m, 0], d[m, 1], d[m, 2] = u, v, w
        r2[m] = u * u + v * v + w * w


@njit(cache=True, nogil=True)
def surroundings(n, i, j, d, r2):
    """Half list -> the neighbours of each atom: start (n+1,), neighbour, vector from the atom to it (2m, 3), squared distance."""
    start = np.zeros(n + 1, np.int64)
    for m in range(len(i)):
        start[i[m] + 1] += 1
        start[j[m] + 1] += 1
    for k in range(n):
        start[k + 1] += start[k]
    at = start[:-1].copy()
    total = start[n]
    other, vector, square = np.empty(total, np.int64), np.empty((total, 3)), np.empty(total)
    for m in range(len(i)):
        for side in range(2):
            a, b, sign = (i[m], j[m], -1.0) if side == 0 else (j[m], i[m], 1.0)
            p = at[a]
            at[a] += 1
            other[p] = b
            square[p] = r2[m]
            for c in range(3):
                vector[p, c] = sign * d[m, c]
    return start, other, vector, square


@njit(cache=True, nogil=True)
def radial(x, row, i, j, code, shifts, type_of, member, lists_start, lists, inverse_width, counts):
    """Count pairs by distance: `counts (histograms, bins)`.

    `lists_start (nt, nt)`, `lists`: for two types the histograms of central type and other type, ended by -1; `member (n,)`.
    """
    bins = counts.shape[1]
    for m in range(len(i)):
        a, b, s = i[m], j[m], code[m] >> 2
        u = x[0, a] - (x[0, b] + shifts[s, 0])
        v = x[1, a] - (x[1, b] + shifts[s, 1])
        w = x[2, a] - (x[2, b] + shifts[s, 2])
        k = int(np.sqrt(u * u + v * v + w * w) * inverse_width)
        if k >= bins:
            continue
        ra, rb = row[a], row[b]
        if not (member[ra] and member[rb]):
            continue
        ta, tb = type_of[ra], type_of[rb]
        for first, second in ((ta, tb), (tb, ta)):
            h = lists_start[first, second]
            while lists[h] >= 0:
                counts[lists[h], k] += 1
                h += 1


@njit(cache=True, nogil=True)
def angular(centres, types, start, other, vector, square, member, ranges, radii, ordinate, counts, centres_counted):
    """Count angles at atoms `centres`, each once: `counts (histograms, bins)`, `centres_counted (histograms,)`.

    `ranges (histograms, 6)`: types of the centre, the first and the second neighbour, both ends included; `radii (histograms, 4)`: squared
    inner and outer distances of the two; `ordinate`: 0 degrees, 1 radians, 2 cosine.
    """
    bins = counts.shape[1]
    for i in centres:
        low, high = start[i], start[i + 1]
        for h in range(len(ranges)):
            if not ranges[h, 0] <= types[i] <= ranges[h, 1]:
                continue
            centres_counted[h] += 1
            for p in range(low, high):
                a = other[p]
                if not member[a]:
                    continue
                a_first = ranges[h, 2] <= types[a] <= ranges[h, 3] and radii[h, 0] <= square[p] <= radii[h, 1]
                a_second = ranges[h, 4] <= types[a] <= ranges[h, 5] and radii[h, 2] <= square[p] <= radii[h, 3]
                if not (a_first or a_second):
                    continue
                for q in range(p + 1, high):
                    b = other[q]
                    if not member[b]:
                        continue
                    b_first = ranges[h, 2] <= types[b] <= ranges[h, 3] and radii[h, 0] <= square[q] <= radii[h, 1]
                    b_second = ranges[h, 4] <= types[b] <= ranges[h, 5] and radii[h, 2] <= square[q] <= radii[h, 3]
                    if not (a_first and b_second or a_second and b_first):
                        continue
                    dot = vector[p, 0] * vector[q, 0] + vector[p, 1] * vector[q, 1] + vector[p, 2] * vector[q, 2]
                    cosine = min(max(dot / (np.sqrt(square[p]) * np.sqrt(square[q])), -1.0), 1.0)
                    if ordinate == 0:
                        k = int(np.arccos(cosine) * (180.0 / np.pi) * (bins / 180.0))
                    elif ordinate == 1:
                        k = int(np.arccos(cosine) * (bins / np.pi))
                    else:
                        k = int((cosine + 1.0) * (bins / 2.0))
                    counts[h, min(k, bins - 1)] += 1
