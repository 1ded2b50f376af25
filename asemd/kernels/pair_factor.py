"""Pair forces over a plain list whose atoms have a factor each: the force on an atom is multiplied by its own.

Such forces have no energy, and those on the two atoms of a pair are not opposite. The virial is that of the pair's mean force, which does
not depend on where the origin is. Constants and the function made from the style are those of `asemd.kernels.pair_list`.
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.pair_sums import add, eight

ENERGY = PER_ATOM = CHARGED = False
pair_energy_one = None


def factor_forces(x, f, q, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays, qqr2e, acc,
                  atom_energy, atom_virial, bad, factor):
    """As `asemd.kernels.pair_list.list_forces`, with `factor (cap,)` by slot."""
    for m in range(lo, hi):
        i = pair_i[m]
        j = pair_j[m]
        kind = code[m] & 3
        image = code[m] >> 2
        dx = x[0, i] - x[0, j] - shifts[image, 0]
        dy = x[1, i] - x[1, j] - shifts[image, 1]
        dz = x[2, i] - x[2, j] - shifts[image, 2]
        r2 = dx * dx + dy * dy + dz * dz
        qq = 0.0
        if CHARGED:
            qq = qqr2e * q[i] * q[j]
        fp, ev, ec = pair_energy_one(r2, qq, weight_lj[kind], weight_coul[kind], rows, constants, arrays, type_of[i], type_of[j])
        if not abs(fp) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = m
                bad[2] = np.sqrt(r2)
            continue
        f[0, i] += factor[i] * dx * fp
        f[1, i] += factor[i] * dy * fp
        f[2, i] += factor[i] * dz * fp
        f[0, j] -= factor[j] * dx * fp
        f[1, j] -= factor[j] * dy * fp
        f[2, j] -= factor[j] * dz * fp
        if ENERGY:
            mean = 0.5 * (factor[i] + factor[j]) * fp
            add(acc, eight(0.0, 0.0, dx, dy, dz, mean * dx, mean * dy, mean * dz))
