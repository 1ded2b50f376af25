"""Listing which clusters' atoms come near each other.

`CLUSTER` consecutive atoms form a cluster, see `asemd.kernels.sort`. The list is half: cluster i holds single atoms j of later clusters
(all images), and of its own cluster the images on the positive side. An entry is slot number + (shift code << 26); the code counts image
-1, 0, 1 in base three, 13 is no shift, so no ghost atoms exist.

These are ordinary Python functions; `asemd.kernels.generate` pastes and compiles them. `CLUSTER` and `ORTHO` are constants of the
generated module, and so are MARK (which atoms are beyond reach is wanted), SORTED (rows are), TRACK, see `arrange`, and SIEVE, whether
`asemd.kernels.sieve` does its work. What follows from
a list (exclusions, plain pairs, rows of atoms) is in `asemd.kernels.cluster_rows`, shorter lists for a few steps in `.prune`.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.candidates import copy8
from asemd.kernels.columns import column, near_columns, stands
from asemd.kernels.gaps import squeeze

CLUSTER = 8
ORTHO = MARK = TRACK = SORTED = True
SIEVE = False
arrange16 = None
SLOT_BITS = 0x3FFFFFF


def reached(tx, ty, tz, codes, nt, x, y, z, s, m, r2):
    """Sets bits 32 to 39 of the codes of candidates 0 to nt - 1: which of the first m atoms of the cluster, at place s of x, y, z, reach
    them. A sum in floating point, written out, vectorises."""
    gone = 1e150
    x0, y0, z0 = (x[s + 0], y[s + 0], z[s + 0]) if m > 0 else (gone, gone, gone)
    x1, y1, z1 = (x[s + 1], y[s + 1], z[s + 1]) if m > 1 else (gone, gone, gone)
    x2, y2, z2 = (x[s + 2], y[s + 2], z[s + 2]) if m > 2 else (gone, gone, gone)
    x3, y3, z3 = (x[s + 3], y[s + 3], z[s + 3]) if m > 3 else (gone, gone, gone)
    x4, y4, z4 = (x[s + 4], y[s + 4], z[s + 4]) if m > 4 else (gone, gone, gone)
    x5, y5, z5 = (x[s + 5], y[s + 5], z[s + 5]) if m > 5 else (gone, gone, gone)
    x6, y6, z6 = (x[s + 6], y[s + 6], z[s + 6]) if m > 6 else (gone, gone, gone)
    x7, y7, z7 = (x[s + 7], y[s + 7], z[s + 7]) if m > 7 else (gone, gone, gone)
    for t in range(nt):
        near = 0.0
        a, b, c = tx[t] - x0, ty[t] - y0, tz[t] - z0
        near += 1.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x1, ty[t] - y1, tz[t] - z1
        near += 2.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x2, ty[t] - y2, tz[t] - z2
        near += 4.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x3, ty[t] - y3, tz[t] - z3
        near += 8.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x4, ty[t] - y4, tz[t] - z4
        near += 16.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x5, ty[t] - y5, tz[t] - z5
        near += 32.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x6, ty[t] - y6, tz[t] - z6
        near += 64.0 if a * a + b * b + c * c <= r2 else 0.0
        a, b, c = tx[t] - x7, ty[t] - y7, tz[t] - z7
        near += 128.0 if a * a + b * b + c * c <= r2 else 0.0
        codes[t] |= np.int64(np.int32(near)) << 32


def drop(codes, nt):
    """Take out candidates that nobody reaches; returns how many are left. The counter stays for them: no branches to mispredict."""
    kept = 0
    for t in range(nt):
        codes[np.uint64(kept)] = codes[t]
        kept += ((codes[t] >> 32) & 0xFF) != 0
    return kept


def arrange(ci, codes, kept, start, entries, own, span, sorting, tally, width, empty, hide):
    """The row of cluster `ci` from ``entries[start]`` on, as `build` says, from its candidates; returns where it ends.

    With MARK `hide` gets the atoms that do not reach an entry; with TRACK, ``hide[old]`` the place in the row of what bits 40 on of a
    code say was at place `old`.
    """
    # counting sort by first + last pair in need; the counters are fields of two numbers, so that none waits for memory
    below = above = np.uint64(0)
    for t in range(kept):
        w = np.uint64((codes[np.uint64(t)] >> 32) & 0xFF)
        below += sorting[0, w]
        above += sorting[1, w]
    before = 0
    for k in range(8):
        here = np.int64(((below if k < 4 else above) >> np.uint64(16 * (k % 4))) & np.uint64(0xFFFF))
        tally[k] = before
        before += here
    mine = (tally[3] // width) * width      # the cluster's own place; what it displaces goes behind it
    for pair in range(4):
        span[ci, 2 * pair] = min((tally[pair] // width) * width, mine)
        span[ci, 2 * pair + 1] = ((tally[pair + 4] + CLUSTER + width - 1) // width) * width
    own[ci] = mine
    for k in range(CLUSTER):
        entries[start + mine + k] = np.int32(ci * CLUSTER + k) | np.int32(13 << 26)
    below = above = np.uint64(0)
    for k in range(4):
        below |= np.uint64(tally[k]) << np.uint64(16 * k)
        above |= np.uint64(tally[k + 4]) << np.uint64(16 * k)
    for t in range(kept):
        e = codes[np.uint64(t)]
        w = np.uint64((e >> 32) & 0xFF)
        one = sorting[0, w]
        side = below if one != 0 else above
        q = np.int64((side >> sorting[2, w]) & np.uint64(0xFFFF))
        below += one
        above += sorting[1, w]
        q += CLUSTER if q >= mine else 0
        entries[np.uint64(start + q)] = np.int32(e & 0xFFFFFFFF)
        if MARK:
            hide[np.uint64(start + q)] = np.uint8(255 - (e >> 32))
        if TRACK:
            hide[np.uint64(e >> 40)] = q
    n = start + kept + CLUSTER
    while (n - start) % max(width, CLUSTER) != 0:
        entries[n] = np.int32(empty) | np.int32(13 << 26)
        if MARK:
            hide[n] = np.uint8(255)
        n += 1
    return n


def append(ci, codes, kept, start, entries, own, span, width, empty, hide):
    """The row as `arrange` makes it, but in no order: the cluster stands first, and all of its atoms need the whole row."""
    own[ci] = 0
    for k in range(CLUSTER):
        entries[start + k] = np.int32(ci * CLUSTER + k) | np.int32(13 << 26)
    first, n = start + CLUSTER, start + CLUSTER + kept
    for t in range(kept):
        entries[np.uint64(first + t)] = np.int32(codes[np.uint64(t)] & 0xFFFFFFFF)
    for t in range(kept):
        hide[np.uint64(first + t)] = np.uint8(255 - (codes[np.uint64(t)] >> 32))
    while (n - start) % max(width, CLUSTER) != 0:
        entries[n] = np.int32(empty) | np.int32(13 << 26)
        hide[n] = np.uint8(255)
        n += 1
    for pair in range(4):
        span[ci, 2 * pair], span[ci, 2 * pair + 1] = 0, n - start
    return n


def build(x, row, cell_start, column_start, column_of, origin, inverse, widths, periodic, shifts, nx, ny, nz, reach, c0, c1,
          first, entries, own, span, unshifted, work, codes, width, empty, longest, sorting, hide, places):
    """List of clusters c0..c1-1 into `entries`; returns its length, -1 if `entries` is too small, -2 if the work arrays are,
    -4 if a cluster has more neighbours than can be counted.

    `shifts (27, 3)`; `widths (3,)`: perpendicular widths of the bin cell; `work (3, w)`, `codes (w,)`: candidates of one cluster.
    With SORTED, a row is sorted so that each of the four pairs of atoms in the cluster needs one stretch of it only, ``span[c, 2 p]`` to
    ``span[c, 2 p + 1]``: by the sum of the first and the last pair (0 to 3) in need of an entry, which is counted as `sorting (3, 256)`
    says for the bits of the atoms that reach it; pair p then needs the sums p to p + 3. The cluster itself stands in the middle, at
    ``own[c]``. Stretches begin and end with vectors of `width`; rows end with copies of the slot `empty`, so that they fill such vectors
    and clusters.
    `unshifted[c]` is set if no entry of cluster c needs a shift; `longest[0]` is the length of the longest row. With MARK each entry gets
    in `hide` the bits of the atoms of the cluster that are beyond reach. With `places` (see `asemd.kernels.gaps`) `widths` are what is
    left of them.
    """
    n = np.int64(0)         # not a literal: a function called with one is compiled for it, too
    r2 = reach * reach
    tx, ty, tz = work[0], work[1], work[2]
    wa = widths[0] / nx
    wb = widths[1] / ny
    ra = int(reach / wa) + 1
    rb = int(reach / wb) + 1
    capacity = codes.shape[0]
    most_entries = np.int64(0)      # and not longest[0], lest threads wait for each other's line of the cache
    tally = np.zeros(8, np.int64)
    if SIEVE:
        spare = np.empty((5, capacity + 16), np.int32)
        order, tags, keys, to_order, to_tags = spare[0], spare[1], spare[2], spare[3], spare[4]
    most = 3 * min(2 * ra + 1, 3 * nx) * min(2 * rb + 1, 3 * ny) + 1
    run_start, run_count, run_code = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
    index_a, image_a, gap_a = np.empty(2 * ra + 1, np.int64), np.empty(2 * ra + 1, np.int64), np.empty(2 * ra + 1)
    index_b, image_b, gap_b = np.empty(2 * rb + 1, np.int64), np.empty(2 * rb + 1, np.int64), np.empty(2 * rb + 1)
    for ci in range(c0, c1):
        first[ci] = n
        ca, cb = stands(column_of[ci], nx, ny)
        lo0, lo1, lo2, hi0, hi1, hi2 = 1e300, 1e300, 1e300, -1e300, -1e300, -1e300
        m = np.int64(0)
        for k in range(ci * CLUSTER, ci * CLUSTER + CLUSTER):
            if row[k] >= 0:
                m += 1
                dx = x[0, k] - origin[0]
                dy = x[1, k] - origin[1]
                dz = x[2, k] - origin[2]
                s0 = squeeze(dx * inverse[0, 0] + dy * inverse[1, 0] + dz * inverse[2, 0], places, 0)
                s1 = squeeze(dx * inverse[0, 1] + dy * inverse[1, 1] + dz * inverse[2, 1], places, 1)
                s2 = squeeze(dx * inverse[0, 2] + dy * inverse[1, 2] + dz * inverse[2, 2], places, 2)
                lo0 = min(lo0, s0)
                hi0 = max(hi0, s0)
                lo1 = min(lo1, s1)
                hi1 = max(hi1, s1)
                lo2 = min(lo2, s2)
                hi2 = max(hi2, s2)
        nt = np.int64(0)
        runs = 0        # stretches of candidates are found first and copied then, lest a wrong guess of one's length wait for its root
        all_in = True
        na = near_columns(ca, nx, ra, lo0, hi0, widths[0], reach, periodic[0], index_a, image_a, gap_a)
        nb = near_columns(cb, ny, rb, lo1, hi1, widths[1], reach, periodic[1], index_b, image_b, gap_b)
        for ka in range(na):
            sa = image_a[ka]
            ga = gap_a[ka]
            for kb in range(nb):
                c2 = column(index_a[ka], index_b[kb], nx, ny)
                if column_start[np.uint64(c2 + 1)] <= ci * CLUSTER:
                    continue
                sb = image_b[kb]
                rz = reach / widths[2]
                if ORTHO:
                    rest = r2 - ga - gap_b[kb]
                    if rest <= 0.0:
                        continue
                    rz = math.sqrt(rest) / widths[2]
                z0 = int(math.floor((lo2 - rz) * nz))
                z1 = int(math.floor((hi2 + rz) * nz))
                if not periodic[2]:
                    z0 = max(z0, 0)
                    z1 = min(z1, nz - 1)
                for sc in range(0 if z0 >= 0 else -1, 1 if z1 < nz else 2):
                    a0 = max(z0, sc * nz)
                    a1 = min(z1, sc * nz + nz - 1)
                    if a1 < a0:
                        continue
                    code = (sa + 1) * 9 + (sb + 1) * 3 + sc + 1
                    start = (ci + 1) * CLUSTER if code <= 13 else ci * CLUSTER
                    k0 = max(cell_start[np.uint64(c2), np.uint64(a0 - sc * nz)], start)
                    k1 = cell_start[np.uint64(c2), np.uint64(a1 - sc * nz + 1)]
                    run_start[runs] = k0
                    run_count[runs] = k1 - k0
                    run_code[runs] = code
                    runs += k1 > k0
        for run in range(runs):
            k0 = run_start[run]
            count = run_count[run]
            code = run_code[run]
            if nt + count + 2 * CLUSTER > capacity:
                return -2
            if code != 13:
                all_in = False
            px = shifts[code, 0]
            py = shifts[code, 1]
            pz = shifts[code, 2]
            high = np.int64(code << 26)
            for q in range(0, count, 8):             # what is copied beyond the end is overwritten
                copy8(tx, ty, tz, codes, nt + q, x, k0 + q, px, py, pz, high)
            nt += count
        unshifted[ci] = all_in
        for k in range(CLUSTER):     # the cluster itself, for its places in `hide`
            tx[nt + k] = x[0, ci * CLUSTER + k]
            ty[nt + k] = x[1, ci * CLUSTER + k]
            tz[nt + k] = x[2, ci * CLUSTER + k]
            codes[nt + k] = np.int64(0)
        reached(tx, ty, tz, codes, nt + CLUSTER, x[0], x[1], x[2], ci * CLUSTER, m, r2)
        if n + nt + 2 * CLUSTER + width > entries.shape[0]:
            return -1
        start = n
        if SIEVE:
            n = arrange16(ci, codes, nt, start, entries, own, span, tally, width, empty, hide, order, tags, keys, to_order, to_tags)
            if tally[7] > 0xFFFF - CLUSTER:
                return -4
        else:
            kept = drop(codes, nt)
            if kept > 0xFFFF - CLUSTER:
                return -4
            if SORTED:
                n = arrange(ci, codes, kept, start, entries, own, span, sorting, tally, width, empty, hide)
            else:
                n = append(ci, codes, kept, start, entries, own, span, width, empty, hide)
        if MARK:
            for k in range(CLUSTER):
                hide[start + own[ci] + k] = np.uint8(255 - (codes[nt + k] >> 32))
        most_entries = max(most_entries, n - start)
    first[c1] = n
    longest[0] = most_entries
    return n
