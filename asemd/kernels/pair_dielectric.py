"""Forces between charges of which each stands in a medium of its own, for each pair of a list: those on the two are not opposite.

The force on an atom is its charge times the field of the other one, which is weakened by the dielectric constant where that other one is.
Energy and virial are those of the mean of both; where a long-range solver has the rest, what `special_bonds` takes off a pair is the energy
of its scaled charges, as in LAMMPS. Forces without charges are as in `asemd.kernels.pair_list`.

Constants of the generated module: ENERGY, PER_ATOM, LONG. From the style: `pair_energy_one(r2, qq, lj, coul, whole, rows, constants,
arrays, ti, tj)` -> force/r without charges, force/r of charges, E_vdwl, E_coul.
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.pair_sums import add, eight

ENERGY = PER_ATOM = LONG = False
pair_energy_one = None


def dielectric_forces(x, f, q, epsilon, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays,
                      qqr2e, acc, atom_energy, atom_virial, bad):
    """Pairs lo..hi-1: forces added to `f`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and `atom_virial (6, cap)`;
    `epsilon (cap,)`: dielectric constants of the slots.

    `bad (4,)`: 1, the first pair whose energy is not finite, its distance.
    """
    for m in range(lo, hi):
        i = np.uint32(pair_i[np.uint64(m)])
        j = np.uint32(pair_j[np.uint64(m)])
        kind = np.uint32(code[np.uint64(m)] & 3)
        image = np.uint32(code[np.uint64(m)] >> 2)
        dx = x[0, i] - x[0, j] - shifts[image, 0]
        dy = x[1, i] - x[1, j] - shifts[image, 1]
        dz = x[2, i] - x[2, j] - shifts[image, 2]
        r2 = dx * dx + dy * dy + dz * dz
        ti = np.uint32(type_of[i])
        tj = np.uint32(type_of[j])
        qq = qqr2e * q[i] * q[j]
        fp, fc, ev, ec = pair_energy_one(r2, qq, weight_lj[kind], weight_coul[kind], weight_coul[0], rows, constants,
                                         arrays, ti, tj)
        if not abs(ev + ec) < np.inf or not abs(fp + fc) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = m
                bad[2] = np.sqrt(r2)
            continue
        on_i = fp + fc / epsilon[j]
        on_j = fp + fc / epsilon[i]
        f[0, i] += on_i * dx
        f[1, i] += on_i * dy
        f[2, i] += on_i * dz
        f[0, j] -= on_j * dx
        f[1, j] -= on_j * dy
        f[2, j] -= on_j * dz
        part = 0.5 * (1.0 / epsilon[i] + 1.0 / epsilon[j])
        if LONG and kind != 0:
            whole = pair_energy_one(r2, qq, weight_lj[kind], weight_coul[0], weight_coul[0], rows, constants, arrays, ti, tj)[3]
            ec = part * whole - (whole - ec) / (epsilon[i] * epsilon[j])
        else:
            ec *= part
        mean = 0.5 * (on_i + on_j)
        if ENERGY:
            add(acc, eight(ev, ec, dx, dy, dz, mean * dx, mean * dy, mean * dz))
        if PER_ATOM:
            for s, on in ((i, on_i), (j, on_j)):
                atom_energy[s] += 0.5 * (ev + ec)
                atom_virial[0, s] += 0.5 * on * dx * dx
                atom_virial[1, s] += 0.5 * on * dy * dy
                atom_virial[2, s] += 0.5 * on * dz * dz
                atom_virial[3, s] += 0.5 * on * dx * dy
                atom_virial[4, s] += 0.5 * on * dx * dz
                atom_virial[5, s] += 0.5 * on * dy * dz
