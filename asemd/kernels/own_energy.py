"""Energy that charges have by themselves, q (a + b q) with two numbers a, b of each type; no forces."""
from __future__ import annotations

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def nothing(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """Where only forces are wanted."""


@njit(cache=True, nogil=True)
def energies(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """Slots lo..hi-1, times `factor (1,)`, into ``acc[1]``."""
    total = 0.0
    for s in range(lo, hi):
        if row[s] >= 0:
            total += q[s] * (numbers[0, type_of[s]] + numbers[1, type_of[s]] * q[s])
    acc[1] += factor[0] * total


@njit(cache=True, nogil=True)
def of_atoms(q, type_of, row, lo, hi, numbers, factor, acc, share):
    """The same, and each atom's into `share (cap,)`."""
    for s in range(lo, hi):
        if row[s] >= 0:
            e = factor[0] * q[s] * (numbers[0, type_of[s]] + numbers[1, type_of[s]] * q[s])
            acc[1] += e
            share[s] += e
