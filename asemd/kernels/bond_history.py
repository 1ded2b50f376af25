"""Loop over bonds with a past: a reference length of their own, forces that depend on the relative velocity, breaking.

`asemd.kernels.bonded` pastes `bond` behind the constants ENERGY, PER_ATOM, PERIODIC, BREAKS, REFERENCE, RATE and the functions `evaluate`
(the style) and `closest`; its arguments are those of `asemd.kernels.bond.bond`. The type of a bond that breaks becomes 0. Where the style
asks for a reference, `arrays` ends with `history (m, 6)` (reference length, last rate, middle and step of the break), the velocities
(3, cap) and `clock (2,)`, whose second number is the step. `asemd.kernels.pair` pastes `broken_pairs` behind `list_forces`.
"""
from __future__ import annotations

import math

import numpy as np

ENERGY = PER_ATOM = PERIODIC = BREAKS = REFERENCE = RATE = False


def bond(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        if types[m] == 0:
            continue
        i, j = np.uint32(items[m, 0]), np.uint32(items[m, 1])
        dx, dy, dz = x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]
        if PERIODIC:
            dx, dy, dz = closest(dx, dy, dz, cell)
        r = math.sqrt(dx * dx + dy * dy + dz * dz)
        rate, reference = 0.0, 1.0
        if REFERENCE:
            reference = arrays[-3][m, 0]
        if RATE:
            if PER_ATOM:         # asked after the step, when velocities have gone on
                rate = arrays[-3][m, 1]
            elif r > 0.0:
                v = arrays[-2]
                rate = (dx * (v[0, i] - v[0, j]) + dy * (v[1, i] - v[1, j]) + dz * (v[2, i] - v[2, j])) / r
                arrays[-3][m, 1] = rate
        e, slope = evaluate(r, types[m], coeff, arrays, rate, reference)
        if BREAKS:
            if slope != slope and r == r:
                if not PER_ATOM:
                    types[m] = 0
                    if REFERENCE:
                        past = arrays[-3]
                        past[m, 2], past[m, 3], past[m, 4] = x[0, i] - 0.5 * dx, x[1, i] - 0.5 * dy, x[2, i] - 0.5 * dz
                        past[m, 5] = arrays[-1][1]
                continue
        if not (math.isfinite(e) and math.isfinite(slope)):
            report(bad, m, r)
            continue
        w = -slope / r if r > 0.0 else 0.0      # at r = 0 the force has no direction
        fx, fy, fz = w * dx, w * dy, w * dz
        push(out, i, fx, fy, fz)
        push(out, j, -fx, -fy, -fz)
        if ENERGY:
            energy += e
            vxx += dx * fx
            vyy += dy * fy
            vzz += dz * fz
            vxy += dx * fy
            vxz += dx * fz
            vyz += dy * fz
        if PER_ATOM:
            for a in (i, j):
                share(a, 0.5, e, dx * fx, dy * fy, dz * fz, dx * fy, dx * fz, dy * fz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)


def broken_pairs(x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                 atom_energy, atom_virial, bad, bond_types):
    """The pairs of bonds: kind 1 while a bond holds, 0 once it is broken."""
    if not PER_ATOM:
        for m in range(lo, hi):
            if bond_types[m] == 0 and code[m] & 3 == 1:
                code[m] -= 1
    list_forces(x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                atom_energy, atom_virial, bad)
