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
def coordination(x, row, i, j, code, shifts, limit, types, counts_as, ranges, out):
    """Count the neighbours of atoms closer than the root of `limit`, by atom row: `out (n, k)` those of types ``ranges (k, 2)``, both ends
    included, that are `counts_as (n,)`."""
    for m in range(len(i)):
        a, b, s = i[m], j[m], code[m] >> 2
        u = x[0, a] - (x[0, b] + shifts[s, 0])
        v = x[1, a] - (x[1, b] + shifts[s, 1])
        w = x[2, a] - (x[2, b] + shifts[s, 2])
        if u * u + v * v + w * w < limit:
            p, q = row[a], row[b]
            for k in range(len(ranges)):
                if counts_as[q] and ranges[k, 0] <= types[q] <= ranges[k, 1]:
                    out[p, k] += 1.0
                if counts_as[p] and ranges[k, 0] <= types[p] <= ranges[k, 1]:
                    out[q, k] += 1.0


@njit(cache=True, nogil=True)
def radial(x, kind, i, j, code, shifts, inverse_width, counts):
    """Count pairs by distance: `counts (kinds, kinds, bins + 1)`, beyond the last bin in one more; ``kind (cap,)`` of each slot."""
    bins = counts.shape[2] - 1
    for m in range(len(i)):
        a, b, s = i[m], j[m], code[m] >> 2
        u = x[0, a] - (x[0, b] + shifts[s, 0])
        v = x[1, a] - (x[1, b] + shifts[s, 1])
        w = x[2, a] - (x[2, b] + shifts[s, 2])
        counts[kind[a], kind[b], int(min(np.sqrt(u * u + v * v + w * w) * inverse_width, bins))] += 1


@njit(cache=True, nogil=True)
def radial_clusters(x, row, kind, first, entries, own, span, c0, c1, shifts, inverse_width, counts):
    """As `radial`, for all pairs of clusters c0..c1-1 of a cluster list without exclusions (see `asemd.kernels.cluster`)."""
    bins = counts.shape[2] - 1
    longest = 0
    for ci in range(c0, c1):
        longest = max(longest, first[ci + 1] - first[ci])
    px, py, pz = np.empty(longest), np.empty(longest), np.empty(longest)
    other, square = np.empty(longest, np.int32), np.empty(longest)
    near, near_square = np.empty(longest + 1, np.int32), np.empty(longest + 1)
    flat = counts.reshape(-1)
    nk = counts.shape[1] * (bins + 1)
    limit = (bins / inverse_width) ** 2 * (1.0 + 1e-12)
    for ci in range(c0, c1):
        f0 = first[ci]
        n = first[ci + 1] - f0
        for k in range(n):
            e = entries[f0 + k]
            j = np.uint64(e & np.int32(0x3FFFFFF))
            c = np.uint64(e >> 26)
            px[k] = x[0, j] + shifts[c, 0]
            py[k] = x[1, j] + shifts[c, 1]
            pz[k] = x[2, j] + shifts[c, 2]
            other[k] = kind[j] * (bins + 1)
        for a in range(8):
            s = ci * 8 + a
            if row[s] < 0:
                break
            low, mine, high = span[ci, a - a % 2], own[ci], span[ci, a - a % 2 + 1]
            x0, y0, z0 = x[0, s], x[1, s], x[2, s]
            for k in range(low, high):
                u = x0 - px[k]
                v = y0 - py[k]
                w = z0 - pz[k]
                square[k] = u * u + v * v + w * w
            m = 0
            for k in range(low, mine):      # those in reach, without branches to mispredict
                near[np.uint64(m)] = other[np.uint64(k)]
                near_square[np.uint64(m)] = square[np.uint64(k)]
                m += square[np.uint64(k)] < limit
            for k in range(mine + a + 1, high):      # atoms of the cluster before this one have had their turn
                near[np.uint64(m)] = other[np.uint64(k)]
                near_square[np.uint64(m)] = square[np.uint64(k)]
                m += square[np.uint64(k)] < limit
            for k in range(m):
                near[np.uint64(k)] += np.int32(np.sqrt(near_square[np.uint64(k)]) * inverse_width)
            base = kind[s] * nk
            for k in range(m):
                flat[np.uint64(base + near[np.uint64(k)])] += 1


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
