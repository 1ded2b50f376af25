"""Bonds with a past: a reference length of their own, forces that depend on the relative velocity, breaking.

`asemd.kernels.block` calls `recall` before the style and `part` after it. REFERENCE and RATE are the rows of what the style takes, or 0;
BREAKS: its bonds can break. The type of a bond that breaks becomes 0. Where the style asks for a reference, `arrays` ends with
`history (m, 6)` (reference length, last rate, middle and step of the break), the velocities (3, cap) and `clock (2,)`, whose second
number is the step. `asemd.kernels.pair` pastes `broken_pairs` behind `list_forces`.
"""
from __future__ import annotations

from asemd.kernels.algebra import between, dot, member, number, put, times, triple

BREAKS = False
V1 = R = D = E = REFERENCE = RATE = 0


def recall(b, n, first, lo, hi, items, types, arrays, level):
    """What the style takes besides the length."""
    for k in range(n):
        m = first + k
        if REFERENCE:
            put(b, REFERENCE, k, arrays[-3][m, 0])
        if RATE:
            r, rate = number(b, R, k), arrays[-3][m, 1]
            if level < 2:        # shares are asked for after the step, when velocities have gone on
                rate = dot(triple(b, V1, k), between(arrays[-2], member(items, m, 0), member(items, m, 1))) / r if r > 0.0 else 0.0
                arrays[-3][m, 1] = rate
            put(b, RATE, k, rate)


def part(b, n, first, items, types, arrays, x, level):
    """Bonds that break now (the derivative is not a number), and bonds that broke before, have no forces."""
    for k in range(n):
        m, r, slope = first + k, number(b, R, k), number(b, D, k)
        gone = types[m] == 0
        if BREAKS:
            if not gone and slope != slope and r == r:
                gone = True
                if level < 2:
                    types[m] = 0
                    if REFERENCE:
                        past, i, d = arrays[-3], member(items, m, 0), times(0.5, triple(b, V1, k))
                        past[m, 2], past[m, 3], past[m, 4] = x[0, i] - d[0], x[1, i] - d[1], x[2, i] - d[2]
                        past[m, 5] = arrays[-1][1]
        if gone:
            put(b, D, k, 0.0)
            put(b, E, k, 0.0)


def broken_pairs(th, x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                 atom_energy, atom_virial, bad, bond_types):
    """The pairs of bonds: kind 1 while a bond holds, 0 once it is broken."""
    if th.level < 2:
        for m in range(lo, hi):
            if bond_types[m] == 0 and code[m] & 3 == 1:
                code[m] -= 1
    list_forces(th, x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                atom_energy, atom_virial, bad)
