"""Shorter cluster lists for the few steps in which nobody goes far.

A cluster list reaches further than the cutoff by the skin, which costs time at every step: of 10 and 2, three pairs in seven. A pruned list
holds what is within the cutoff and a smaller skin, and is made anew from the whole list when atoms have used that up. No pair that may be
within the cutoff is ever missing.

How much skin: with a cutoff c, a shorter skin s costs 3 s / c of the time of a force evaluation, and making the list a part k of it
every s / u evaluations, where u is how fast two atoms approach each other at most; the sum is least for s = sqrt(k u c / 3).

Constants of the generated module: CLUSTER, and those of `asemd.kernels.cluster` with TRACK.
"""
from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from asemd.kernels import cluster, sieve
from asemd.kernels.gather import gather8
from asemd.kernels.generate import Builder

CLUSTER = 8
MARKED, LANES = sieve.MARKED, sieve.LANES
reached = drop = arrange = reached16 = place16 = pick16 = marked16 = None
SLOT_BITS = 0x3FFFFFF
VALID, SKIN, CALLS, MOST, CUT, RENEWALS, COST = range(7)      # places in `memo`


class Whole(NamedTuple):
    """The list that a shorter one is made of, and what the work needs, for one thread.

    `seen (3, slots)` and `seen_shifts`: positions and image shifts when it was pruned; `memo (7,)`: whether it is valid, its skin,
    evaluations since, the skin of the whole list, the cutoff, how often it was made, what making it costs; `hide`: see
    `asemd.kernels.pair_cluster`, of length 0 if unused; `empty`: an empty slot; `room`, `short`, `codes`, `to`, `tally`: work space, the
    second in single precision.
    """

    first: np.ndarray
    entries: np.ndarray
    own: np.ndarray
    excluded_first: np.ndarray
    excluded: np.ndarray
    hide: np.ndarray
    seen: np.ndarray
    seen_shifts: np.ndarray
    memo: np.ndarray
    room: np.ndarray
    short: np.ndarray
    codes: np.ndarray
    to: np.ndarray
    tally: np.ndarray
    sorting: np.ndarray
    width: int
    empty: int


def renew(near, x, shifts, whole, unshifted, c0, c1, first, entries, own, span, excluded_first, excluded, hide):
    """Make the pruned list of clusters c0..c1-1 anew if it may miss a pair; `near` has the positions `x` by slot."""
    memo, seen = whole.memo, whole.seen
    n = x.shape[1]
    m = 0.0
    for i in range(n):
        a = x[0, i] - seen[0, i]
        b = x[1, i] - seen[1, i]
        c = x[2, i] - seen[2, i]
        m = max(m, a * a + b * b + c * c)
    gone = 0.0
    for k in range(shifts.shape[0]):
        square = 0.0
        for d in range(3):
            square += (shifts[k, d] - whole.seen_shifts[k, d]) ** 2
        gone = max(gone, square)
    nearer = 2.0 * math.sqrt(m) + math.sqrt(gone)
    memo[CALLS] += 1.0
    if memo[VALID] != 0.0 and nearer <= memo[SKIN]:
        return
    if memo[VALID] != 0.0:
        memo[SKIN] = math.sqrt(memo[COST] / 3.0 * memo[CUT] * nearer / memo[CALLS])
    memo[SKIN] = min(max(memo[SKIN], 0.005 * memo[CUT]), 0.9 * memo[MOST])
    memo[VALID], memo[CALLS] = 1.0, 0.0
    memo[RENEWALS] += 1.0
    for d in range(3):
        for i in range(n):
            seen[d, i] = x[d, i]
        for k in range(shifts.shape[0]):
            whole.seen_shifts[k, d] = shifts[k, d]
    reach = memo[CUT] + 1.000001 * memo[SKIN]
    prune(near, shifts, whole, unshifted, c0, c1, reach * reach, first, entries, own, span, excluded_first, excluded, hide)


def prune(near, shifts, whole, unshifted, c0, c1, reach2, first, entries, own, span, excluded_first, excluded, hide):
    """The entries of the whole list that are nearer than the root of `reach2` to an atom of their cluster, in the same form."""
    b, codes, to = whole.room, whole.codes, whole.to
    row = codes.shape[0]
    tx, ty, tz = b[0:row], b[row:2 * row], b[2 * row:3 * row]
    n = taken = 0
    for ci in range(c0, c1):
        first[ci], excluded_first[ci] = n, taken
        s = ci * CLUSTER
        ox, oy, oz = near[s, 0], near[s, 1], near[s, 2]
        f0 = np.int64(whole.first[ci])
        full = np.int64(whole.first[ci + 1]) - f0
        if unshifted[ci]:
            for k in range(0, full, 8):
                gather8(b, k, row, near, whole.entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, False, 0)
        else:
            for k in range(0, full, 8):
                gather8(b, k, row, near, whole.entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, True, 0)
        for k in range(full):
            codes[np.uint64(k)] = np.int64(whole.entries[np.uint64(f0 + k)]) | (np.int64(k) << 40)
        mine = np.int64(whole.own[ci])
        reached(tx, ty, tz, codes, full, tx, ty, tz, mine, CLUSTER, reach2)      # empty slots are too far away
        for k in range(mine, mine + CLUSTER):
            codes[np.uint64(k)] = 0
        x0, x1 = whole.excluded_first[ci], whole.excluded_first[ci + 1]
        for y in range(x0, x1):
            to[np.int64(whole.excluded[y] & np.int32(0xFFFF))] = -1
        kept = drop(codes, full)
        start = n
        n = arrange(ci, codes, kept, start, entries, own, span, whole.sorting, whole.tally, whole.width, whole.empty, to)
        for k in range(CLUSTER):
            to[mine + k] = own[ci] + k
        if whole.hide.shape[0] > 0:
            for k in range(n - min(max(whole.width, CLUSTER), n - start), n):      # what pads the row
                hide[np.uint64(k)] = 255
            for t in range(kept):
                k = codes[np.uint64(t)] >> 40
                hide[np.uint64(start + to[np.uint64(k)])] = whole.hide[np.uint64(f0 + k)]
            for k in range(mine, mine + CLUSTER):
                hide[start + to[k]] = whole.hide[f0 + k]
        for y in range(x0, x1):
            k = to[np.int64(whole.excluded[y] & np.int32(0xFFFF))]
            if k >= 0:
                excluded[taken] = np.int32((whole.excluded[y] & ~np.int32(0xFFFF)) | k)
                taken += 1
    first[c1], excluded_first[c1] = n, taken


def prune16(near, shifts, whole, unshifted, c0, c1, reach2, first, entries, own, span, excluded_first, excluded, hide):
    """As `prune`, for processors with wide vectors (`asemd.kernels.sieve`). Distances are in single precision, and the reach is a little
    longer, lest a pair be lost."""
    b, to = whole.short, whole.to
    row = to.shape[0]
    tx, ty, tz = b[0:row], b[row:2 * row], b[2 * row:3 * row]
    spare = np.empty((6, row + 16), np.int32)
    order, tags, keys, to_order, to_tags, who = spare[0], spare[1], spare[2], spare[3], spare[4], spare[5]
    r2 = np.float32(1.0001 * reach2)
    n = taken = np.int64(0)
    for ci in range(c0, c1):
        first[ci], excluded_first[ci] = n, taken
        s = ci * CLUSTER
        ox, oy, oz = near[s, 0], near[s, 1], near[s, 2]
        f0 = np.int64(whole.first[ci])
        full = np.int64(whole.first[ci + 1]) - f0
        if unshifted[ci]:
            for k in range(0, full, 8):
                gather8(b, k, row, near, whole.entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, False, 0)
        else:
            for k in range(0, full, 8):
                gather8(b, k, row, near, whole.entries, f0 + k, ox, oy, oz, shifts, SLOT_BITS, True, 0)
        mine = np.int64(whole.own[ci])
        reached16(tx, ty, tz, who, (full + 15) // 16 * 16, mine, r2)
        for k in range(mine, mine + CLUSTER):
            who[np.uint64(k)] = 0
        x0, x1 = whole.excluded_first[ci], whole.excluded_first[ci + 1]
        for y in range(x0, x1):
            k = np.int64(whole.excluded[y] & np.int32(0xFFFF))
            to[k] = -1
            who[k] |= MARKED
        start, kept, found = n, np.int64(0), np.int64(0)
        if whole.hide.shape[0] > 0:
            for t in range(0, full, LANES):
                kept = pick16(whole.entries, f0, who, whole.hide, t, full, order, tags, keys, kept)
        else:
            for t in range(0, full, LANES):
                kept = pick16(whole.entries, f0, who, None, t, full, order, tags, keys, kept)
        n = place16(ci, kept, start, entries, own, span, whole.tally, whole.width, whole.empty, order, tags, keys, to_order,
                    to_tags)
        here = np.int64(own[ci])
        for k in range(CLUSTER):
            to[mine + k] = here + k
        if x1 > x0:
            for t in range(0, kept, LANES):
                found = marked16(to_tags, t, kept, keys, found)
            for k in range(found):
                q = np.int64(keys[k])
                to[np.int64((to_tags[q] & (MARKED - 1)) >> 8)] = q + (CLUSTER if q >= here else 0)
        if whole.hide.shape[0] > 0:
            for q in range(here):
                hide[np.uint64(start + q)] = np.uint8(to_tags[np.uint64(q)] & 255)
            for q in range(here, kept):
                hide[np.uint64(start + CLUSTER + q)] = np.uint8(to_tags[np.uint64(q)] & 255)
            for k in range(CLUSTER):
                hide[start + here + k] = whole.hide[f0 + mine + k]
            for k in range(start + kept + CLUSTER, n):
                hide[k] = 255
        for y in range(x0, x1):
            k = to[np.int64(whole.excluded[y] & np.int32(0xFFFF))]
            if k >= 0:
                excluded[taken] = np.int32((whole.excluded[y] & ~np.int32(0xFFFF)) | k)
                taken += 1
    first[c1], excluded_first[c1] = n, taken


@cache
def module():
    """The compiled functions."""
    b = Builder("pruned cluster lists")
    b.line("from asemd.kernels.gather import gather8")
    for name, value in dict(CLUSTER=CLUSTER, SLOT_BITS=SLOT_BITS, MARK=False, TRACK=True, COST=COST, VALID=VALID, SKIN=SKIN, CALLS=CALLS,
                            MOST=MOST, CUT=CUT, RENEWALS=RENEWALS).items():
        b.constant(name, value)
    if sieve.WIDE:
        sieve.named(b)
    pieces = (sieve.reached16, sieve.place16) if sieve.WIDE else (cluster.reached, cluster.drop, cluster.arrange)
    for f in pieces:
        b.function(f, fast=True)
    b.function(prune16 if sieve.WIDE else prune, "prune", fast=True)
    b.function(renew, fast=True)
    return b.build()
