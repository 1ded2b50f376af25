"""Pairs of a plain list that are in reach, one after the other in a work space.

Which pairs are, is hard for a processor to guess: differences of all are written, and the place moves on for those in reach. What follows
for them all at once can be vector code.

Columns of the work space `b`, ROOM numbers each: the difference of the positions, its square; rows of `who`: slot i, slot j, the number of
the pair.
"""
from __future__ import annotations

import numpy as np

ROOM = 0
place = np.uint64
furthest = None


def in_reach(x, type_of, pair_i, pair_j, code, shifts, first, end, rows, n, b, who):
    """Take up pairs first..end-1 after the `n` that are there; returns how many there are then."""
    for m in range(first, end):
        i = np.uint32(pair_i[place(m)])
        j = np.uint32(pair_j[place(m)])
        image = np.uint32(code[place(m)] >> 2)
        dx = x[0, i] - x[0, j] - shifts[image, 0]
        dy = x[1, i] - x[1, j] - shifts[image, 1]
        dz = x[2, i] - x[2, j] - shifts[image, 2]
        r2 = dx * dx + dy * dy + dz * dz
        b[place(n)] = dx
        b[place(n + ROOM)] = dy
        b[place(n + 2 * ROOM)] = dz
        b[place(n + 3 * ROOM)] = r2
        who[0, place(n)] = i
        who[1, place(n)] = j
        who[2, place(n)] = m
        n += r2 < furthest(rows, type_of[i], type_of[j])
    return n
