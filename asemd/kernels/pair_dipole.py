"""Forces and torques between charges with point dipoles, for each pair of a list.

The energy of two of them at d = x_i - x_j is that of the style's function of the distance, and

    q_i q_j f0 + (q_i p_j - q_j p_i) . d f1 + p_i . p_j f2 - (p_i . d) (p_j . d) f3

Constants of the generated module: ENERGY, PER_ATOM, FIRST (the row of the coefficients where those of the charges begin),
SCALED (there is a factor for the charges and dipoles of each pair of types, in row SCALE).
From the style: `pair_energy_one` of what has neither charges nor dipoles, see `asemd.kernels.pair_list`;
`radial(r2, whole, weight, cut2, constants)` -> f0 f1 f2 f3, and -f'/r of each.
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.pair_sums import add, eight, halve

ENERGY = PER_ATOM = SCALED = False
FIRST = SCALE = 0
pair_energy_one = radial = None


def dipole_forces(x, f, q, mu, row, torque, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays,
                  qqr2e, acc, atom_energy, atom_virial, bad):
    """Pairs lo..hi-1: forces added to `f`, torques to `torque`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and
    `atom_virial (6, cap)`. `mu (n, 3)`: dipoles by row, `row (cap,)` the rows of the slots.

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
        ec, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
        a0, a1, a2, b0, b1, b2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0      # the electric fields at both
        fp, ev, _ = pair_energy_one(r2, 0.0, weight_lj[kind], weight_coul[kind], weight_coul[0], rows, constants, arrays, ti, tj)
        a, b = np.uint32(row[i]), np.uint32(row[j])
        p0, p1, p2 = mu[a, 0], mu[a, 1], mu[a, 2]
        s0, s1, s2 = mu[b, 0], mu[b, 1], mu[b, 2]
        if r2 < rows[FIRST, ti, tj]:
            f0, f1, f2, f3, g0, g1, g2, g3 = radial(r2, weight_coul[0], weight_coul[kind], rows[FIRST, ti, tj], constants)
            factor = qqr2e
            if SCALED:
                factor *= rows[SCALE, ti, tj]
            qi = factor * q[i]
            qj = factor * q[j]
            qq = qi * q[j]
            pd = p0 * dx + p1 * dy + p2 * dz
            sd = s0 * dx + s1 * dy + s2 * dz
            cross = qi * sd - qj * pd
            ps = factor * (p0 * s0 + p1 * s1 + p2 * s2)
            pd = factor * pd
            ec = qq * f0 + cross * f1 + ps * f2 - pd * sd * f3
            fp += qq * g0 + cross * g1 + ps * g2 - pd * sd * g3
            u = qj * f1 + factor * sd * f3
            w = -qi * f1 + pd * f3
            a0, a1, a2 = u * dx - factor * f2 * s0, u * dy - factor * f2 * s1, u * dz - factor * f2 * s2
            b0, b1, b2 = w * dx - factor * f2 * p0, w * dy - factor * f2 * p1, w * dz - factor * f2 * p2
            u = -qi * f1 + pd * f3
            w = qj * f1 + factor * sd * f3
            gx, gy, gz = u * s0 + w * p0, u * s1 + w * p1, u * s2 + w * p2
        if not abs(ev + ec) < np.inf or not abs(fp) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = m
                bad[2] = np.sqrt(r2)
            continue
        gx += fp * dx
        gy += fp * dy
        gz += fp * dz
        f[0, i] += gx
        f[1, i] += gy
        f[2, i] += gz
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        torque[0, i] += p1 * a2 - p2 * a1
        torque[1, i] += p2 * a0 - p0 * a2
        torque[2, i] += p0 * a1 - p1 * a0
        torque[0, j] += s1 * b2 - s2 * b1
        torque[1, j] += s2 * b0 - s0 * b2
        torque[2, j] += s0 * b1 - s1 * b0
        if ENERGY:
            add(acc, eight(ev, ec, dx, dy, dz, gx, gy, gz))
        if PER_ATOM:
            halve(atom_energy, atom_virial, i, j, ev + ec, dx, dy, dz, gx, gy, gz)
