"""What follows from a cluster list: the entries that special pairs take out, plain pairs, rows of single atoms.

Lists are those of `asemd.kernels.cluster`; `CLUSTER` is a constant of the generated module.
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.cluster import CLUSTER, SLOT_BITS
from asemd.kernels.rebuild import closest

FEW = 160           # partners of a cluster's atoms that are looked for one by one


def find(entries, first, count, j):
    """How often slot `j` is among ``entries[first:first + count]``, times 2^32, plus the sum of its places. A loop for vectors."""
    found = np.int64(0)
    for k in range(count):
        found += k + 4294967296 if (entries[np.uint64(first + k)] & SLOT_BITS) == j else 0
    return found


def previous(entries, first, end, j, mine):
    """The last place before `end` where slot `j` is among the entries from `first` on, but for the cluster itself at `mine`; -1: none."""
    w = end - 1
    while w >= 0 and ((entries[first + w] & SLOT_BITS) != j or (w >= mine and w < mine + CLUSTER)):
        w -= 1
    return w


def exclude(slot_of, row, partner_start, partners, c0, c1, first, entries, own, excluded_first, excluded, where, earlier, x, shifts,
            reduced, close):
    """Entries of the list that special pairs take out, per cluster as (atom in cluster << 16) + place in the cluster's row.

    Returns the number, or -1 if `excluded` is too small. `partner_start, partners`: for each atom row the rows it must not meet.
    `where (cap,)` and `earlier (w,)` are work space, for clusters with many partners; those of the others are looked for one by one. In
    small cells a row can hold two images of an atom. If `close`, two of them can be in reach of an atom: the closest one is special, others
    interact fully; else both are taken out.
    """
    n, seen = 0, np.empty((FEW + 1, 2), np.int64)
    for ci in range(c0, c1):
        excluded_first[ci] = n
        f0 = np.int64(first[ci])
        count = first[ci + 1] - f0
        s, partnerships = ci * CLUSTER, 0
        for a in range(CLUSTER):
            r = row[s + a]
            if r >= 0:
                partnerships += partner_start[r + 1] - partner_start[r]
        known = 0
        for k in range(count if partnerships > FEW else 0):
            if k < own[ci] or k >= own[ci] + CLUSTER:
                j = entries[f0 + k] & SLOT_BITS
                w = where[j]
                listed = w < k and (w < own[ci] or w >= own[ci] + CLUSTER) and (entries[f0 + w] & SLOT_BITS) == j
                earlier[k] = w if listed else -1
                where[j] = k
        for a in range(CLUSTER):
            r = row[s + a]
            if r < 0:
                break
            for q in range(partner_start[r], partner_start[r + 1]):
                j = slot_of[partners[q]]
                if j < s:            # listed in the partner's row
                    continue
                if n + 32 > excluded.shape[0]:
                    return -1
                if j < s + CLUSTER and j > s + a and (
                        not close or closest(x[0, s + a] - x[0, j], x[1, s + a] - x[1, j], x[2, s + a] - x[2, j], reduced)):
                    excluded[n] = np.int32((a << 16) | (j - s + own[ci]))
                    n += 1
                if partnerships > FEW:
                    w = np.int64(where[j])
                    if w >= count or (w >= own[ci] and w < own[ci] + CLUSTER) or (entries[f0 + w] & SLOT_BITS) != j:
                        continue
                    times = 0
                else:
                    m = 0
                    while m < known and seen[m, 0] != j:
                        m += 1
                    if m == known:
                        seen[m, 0], seen[m, 1] = j, find(entries, f0, count, j)
                        if j < s + CLUSTER:
                            seen[m, 1] -= np.int64(own[ci]) + j - s + 4294967296
                        known += 1
                    times = seen[m, 1] >> 32
                    w = previous(entries, f0, count, j, own[ci]) if times > 1 else (seen[m, 1] & 4294967295) if times == 1 else -1
                while w >= 0:
                    excluded[n] = np.int32((a << 16) | w)
                    c = entries[f0 + w] >> 26
                    n += not close or closest(x[0, s + a] - (x[0, j] + shifts[c, 0]), x[1, s + a] - (x[1, j] + shifts[c, 1]),
                                              x[2, s + a] - (x[2, j] + shifts[c, 2]), reduced)
                    if partnerships > FEW:
                        w = np.int64(earlier[w])
                    else:
                        w = previous(entries, f0, w, j, own[ci]) if times > 1 else -1
    excluded_first[c1] = n
    return n


def count(held, row, first, entries, c0, c1, shifts, reach2, partner_start, partners, reduced, close):
    """How many pairs the rows of clusters c0..c1-1 stand for: within `reach2` at the positions `held` the list was built for, partners
    left out, of which `close` means what it does for `exclude`."""
    n = 0
    for ci in range(c0, c1):
        for a in range(ci * CLUSTER, ci * CLUSTER + CLUSTER):
            r = row[a]
            if r < 0:
                break
            for k in range(first[ci], first[ci + 1]):
                j = entries[k] & SLOT_BITS
                c = entries[k] >> 26
                if row[j] < 0 or (c == 13 and j <= a):
                    continue
                dx = held[0, a] - (held[0, j] + shifts[c, 0])
                dy = held[1, a] - (held[1, j] + shifts[c, 1])
                dz = held[2, a] - (held[2, j] + shifts[c, 2])
                if dx * dx + dy * dy + dz * dz <= reach2:
                    met = 0
                    for q in range(partner_start[r], partner_start[r + 1]):
                        met += partners[q] == row[j]
                    n += met == 0 or (close and not closest(dx, dy, dz, reduced))
    return n


def expand(x, row, first, entries, c0, c1, shifts, reach2, out_i, out_j, out_code):
    """The cluster list as plain pairs (slots i, j and shift code) within `reach2`.

    Returns the number, or -1 if the arrays are too small.
    """
    longest = 0
    for ci in range(c0, c1):
        longest = max(longest, first[ci + 1] - first[ci])
    px, py, pz, square = np.empty(longest), np.empty(longest), np.empty(longest), np.empty(longest)
    slot, code = np.empty(longest, np.int32), np.empty(longest, np.int32)
    n = np.int64(0)
    for ci in range(c0, c1):
        s, m = ci * CLUSTER, np.int64(0)
        for k in range(first[ci], first[ci + 1]):
            e = entries[k]
            j = e & SLOT_BITS
            c = e >> 26
            if row[j] < 0 or (c == 13 and j // CLUSTER == ci):
                continue
            px[m], py[m], pz[m] = x[0, j] + shifts[c, 0], x[1, j] + shifts[c, 1], x[2, j] + shifts[c, 2]
            slot[m], code[m] = j, c * 4
            m += 1
        for a in range(CLUSTER):
            if row[s + a] < 0:
                break
            if n + m + CLUSTER > out_i.shape[0]:
                return -1
            for b in range(a + 1, CLUSTER):
                if row[s + b] < 0:
                    break
                dx = x[0, s + a] - x[0, s + b]
                dy = x[1, s + a] - x[1, s + b]
                dz = x[2, s + a] - x[2, s + b]
                if dx * dx + dy * dy + dz * dz < reach2:
                    out_i[n] = s + a
                    out_j[n] = s + b
                    out_code[n] = 13 * 4
                    n += 1
            x0, y0, z0 = x[0, s + a], x[1, s + a], x[2, s + a]
            for k in range(m):
                dx = x0 - px[k]
                dy = y0 - py[k]
                dz = z0 - pz[k]
                square[k] = dx * dx + dy * dy + dz * dz
            for k in range(m):      # without branches to mispredict
                at = np.uint64(n)
                out_i[at], out_j[at], out_code[at] = s + a, slot[np.uint64(k)], code[np.uint64(k)]
                n += square[np.uint64(k)] < reach2
    return n


def rows(row, slot_of, first, entries, hide, own, c0, c1, partner_start, partners, mask_row, molecule_row, rules, marks, near, start,
         owners, neighbors):
    """The cluster list as rows of single atoms: slots of clusters c0..c1-1, entries as in the cluster list.

    `hide` says which atoms of the cluster each entry is out of reach of. Partners (special pairs) and pairs that `rules` forbid are left
    out. `marks (cap,)`, all zero, and `near (w,)` are work space. `start (nslots+1,)`, `neighbors (m,)`, and
    `owners (m,)`, whose row an entry is in; returns the number of entries, or -1 if `neighbors` is too small.
    """
    n = 0
    for ci in range(c0, c1):
        s = ci * CLUSTER
        f0 = np.int64(first[ci])
        count = np.int64(first[ci + 1]) - f0
        mine = np.int64(own[ci])
        if n + CLUSTER * count > neighbors.shape[0]:
            return -1
        for k in range(count):      # the bits of the atoms that have a place in their rows
            near[np.uint64(k)] = np.uint8(255) ^ hide[np.uint64(f0 + k)]
        if partners.shape[0] > 0:
            for a in range(CLUSTER):
                r = row[s + a]
                if r < 0:
                    break
                for q in range(partner_start[r], partner_start[r + 1]):
                    marks[np.uint32(slot_of[np.uint32(partners[np.uint64(q)])])] |= np.uint8(1 << a)
            for k in range(count):      # no branch: whether a partner is listed here is hard to guess
                near[np.uint64(k)] &= ~marks[np.uint32(entries[np.uint64(f0 + k)] & np.int32(SLOT_BITS))]
            for a in range(CLUSTER):
                r = row[s + a]
                if r < 0:
                    break
                for q in range(partner_start[r], partner_start[r + 1]):
                    marks[np.uint32(slot_of[np.uint32(partners[np.uint64(q)])])] = np.uint8(0)
        for a in range(CLUSTER):        # atoms of the cluster before this one have had their turn
            near[np.uint64(mine + a)] &= np.uint8((1 << a) - 1)
        for a in range(CLUSTER):
            start[s + a] = n
            r = row[s + a]
            if r < 0:
                continue
            at = n
            for k in range(count):      # all entries are copied; the counter moves for those that stay: no branches to mispredict
                neighbors[np.uint64(n)] = entries[np.uint64(f0 + k)]
                owners[np.uint64(n)] = s + a
                n += (np.int64(near[np.uint64(k)]) >> a) & 1
            if rules.shape[0] > 0:
                m = at
                for k in range(at, n):
                    entry = neighbors[np.uint64(k)]
                    neighbors[np.uint64(m)] = entry
                    m += not forbidden(r, row[np.uint32(entry & np.int32(SLOT_BITS))], mask_row, molecule_row, rules)
                n = m
    start[c1 * CLUSTER] = n
    return n
