"""Energy that charges have by themselves, with five numbers of each type, or two; no forces."""
from __future__ import annotations

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def nothing(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """Where only forces are wanted."""


@njit(cache=True, nogil=True)
def alone(q, number):
    """q (a + b q), and w times the square of what is beyond the range from l to m; `number (5,)`: a, b, w (0), l, m."""
    beyond = min(q - number[3], 0.0) + max(q - number[4], 0.0)
    return q * (number[0] + number[1] * q) + number[2] * beyond * beyond


@njit(cache=True, nogil=True)
def energies(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """Slots lo..hi-1, times `factor (1,)`, into ``acc[1]``."""
    total = 0.0
    for s in range(lo, hi):
        if row[s] >= 0:
            total += alone(q[s], numbers[type_of[s]])
    acc[1] += factor[0] * total


@njit(cache=True, nogil=True)
def of_atoms(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """The same, and each atom's into `share (cap,)`."""
    for s in range(lo, hi):
        if row[s] >= 0:
            e = factor[0] * alone(q[s], numbers[type_of[s]])
            acc[1] += e
            share[s] += e
