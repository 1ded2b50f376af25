"""Forces and torques between charges with point dipoles, for each pair of a list.

The energy of two of them at d = x_i - x_j is that of the style's function of the distance, and

    q_i q_j f0 + (q_i p_j - q_j p_i) . d f1 + p_i . p_j f2 - (p_i . d) (p_j . d) f3

Constants of the generated module: ENERGY, PER_ATOM, FIRST (the row of the coefficients where those of the charges begin, and how many rows
the others have), SCALED (there is a factor for the charges and dipoles of each pair of types, in row SCALE), ROOM and AT_ONCE.
From the style, of what has neither charges nor dipoles: `pair_energy` -> force/r and energies, in vector code with coefficients from the
work space, see `asemd.kernels.pair`, and `pair_energy_one` for pairs with a weight, see `asemd.kernels.pair_list`. `furthest(rows, ti, tj)`
is the squared reach of a pair of types; `radial(r2, 1/r2, 1/r, whole, weight, cut2, constants)` -> f0 f1 f2 f3, and -f'/r of each.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.pair_reach import in_reach
from asemd.kernels.pair_sums import add, eight, halve

ENERGY = PER_ATOM = SCALED = False
FIRST = SCALE = 0
ROOM, AT_ONCE, COLUMNS = 136, 64, 18      # of the columns, those beside the coefficients
place = np.uint64        # an index that is surely not negative: no wrap-around test, so that loops vectorise
pair_energy = pair_energy_one = radial = furthest = None


def dipole_forces(x, f, q, mu, row, torque, type_of, pair_i, pair_j, code, shifts, weight_lj, weight_coul, lo, hi, rows, constants, arrays,
                  qqr2e, acc, atom_energy, atom_virial, bad, b, who):
    """Pairs lo..hi-1: forces added to `f`, torques to `torque`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and
    `atom_virial (6, cap)`. `mu (n, 3)`: dipoles by row, `row (cap,)` the rows of the slots; work space: `b ((COLUMNS + FIRST) * ROOM,)` and
    `who (3, ROOM)`, see `asemd.kernels.pair_reach`.

    `bad (4,)`: 1, the first pair whose energy is not finite, its distance.
    """
    n = 0
    for first in range(lo, hi, AT_ONCE):
        n = in_reach(x, type_of, pair_i, pair_j, code, shifts, first, min(hi, first + AT_ONCE), rows, n, b, who)
        if n > ROOM - AT_ONCE or first + AT_ONCE >= hi:
            dipoles_at_once(n, f, q, mu, row, torque, type_of, code, weight_lj, weight_coul, rows, constants, arrays, qqr2e, acc,
                            atom_energy, atom_virial, bad, b, who)
            n = 0


def dipoles_at_once(n, f, q, mu, row, torque, type_of, code, weight_lj, weight_coul, rows, constants, arrays, qqr2e, acc, atom_energy,
                    atom_virial, bad, b, who):
    """The first `n` pairs of the work space. Places of a pair in the columns: 4 and 5 the charges, 6 to 11 the dipoles, 12 a factor, 13 the
    squared cutoff, 14 the weight of charges, 15 that of the others or 0 in special pairs, 16 and 17 their force/r and energy,
    then the coefficients."""
    whole = weight_coul[0]
    for k in range(n):
        i, j = np.uint32(who[0, place(k)]), np.uint32(who[1, place(k)])
        kind = np.uint32(code[place(who[2, place(k)])] & 3)
        ti, tj = np.uint32(type_of[i]), np.uint32(type_of[j])
        u, v = np.uint32(row[i]), np.uint32(row[j])
        b[place(k + 4 * ROOM)] = q[i]
        b[place(k + 5 * ROOM)] = q[j]
        for c in range(3):
            b[place(k + (6 + c) * ROOM)] = mu[u, c]
            b[place(k + (9 + c) * ROOM)] = mu[v, c]
        b[place(k + 12 * ROOM)] = qqr2e * rows[SCALE, ti, tj] if SCALED else qqr2e
        b[place(k + 13 * ROOM)] = rows[FIRST, ti, tj]
        b[place(k + 14 * ROOM)] = weight_coul[kind]
        b[place(k + 15 * ROOM)] = weight_lj[kind] if kind == 0 else 0.0
        fp, ev = 0.0, 0.0
        if kind != 0:
            fp, ev, _ = pair_energy_one(b[place(k + 3 * ROOM)], 0.0, weight_lj[kind], weight_coul[kind], whole, rows, constants, arrays,
                                        ti, tj)
        b[place(k + 16 * ROOM)] = fp
        b[place(k + 17 * ROOM)] = ev
        for c in range(FIRST):
            b[place(k + (18 + c) * ROOM)] = rows[c, ti, tj]
    for k in range(n):
        dx, dy, dz, r2 = b[place(k)], b[place(k + ROOM)], b[place(k + 2 * ROOM)], b[place(k + 3 * ROOM)]
        p0, p1, p2 = b[place(k + 6 * ROOM)], b[place(k + 7 * ROOM)], b[place(k + 8 * ROOM)]
        s0, s1, s2 = b[place(k + 9 * ROOM)], b[place(k + 10 * ROOM)], b[place(k + 11 * ROOM)]
        cut2 = b[place(k + 13 * ROOM)]
        ir2 = 1.0 / r2
        ir = math.sqrt(ir2)
        fp, ev, _ = pair_energy(r2, ir2, ir, 0.0, constants, b, k + 18 * ROOM, True)
        weight = b[place(k + 15 * ROOM)]
        fp = weight * fp if weight != 0.0 else b[place(k + 16 * ROOM)]
        ev = weight * ev if weight != 0.0 else b[place(k + 17 * ROOM)]
        f0, f1, f2, f3, g0, g1, g2, g3 = radial(r2, ir2, ir, whole, b[place(k + 14 * ROOM)], cut2, constants)
        factor = b[place(k + 12 * ROOM)] if r2 < cut2 else 0.0
        qi = factor * b[place(k + 4 * ROOM)]
        qj = factor * b[place(k + 5 * ROOM)]
        qq = qi * b[place(k + 5 * ROOM)]
        pd = p0 * dx + p1 * dy + p2 * dz
        sd = s0 * dx + s1 * dy + s2 * dz
        cross = qi * sd - qj * pd
        ps = factor * (p0 * s0 + p1 * s1 + p2 * s2)
        pd = factor * pd
        fp += qq * g0 + cross * g1 + ps * g2 - pd * sd * g3
        t = factor * f2
        u = qj * f1 + factor * sd * f3
        w = -qi * f1 + pd * f3
        b[place(k + 4 * ROOM)] = fp * dx + w * s0 + u * p0
        b[place(k + 5 * ROOM)] = fp * dy + w * s1 + u * p1
        b[place(k + 6 * ROOM)] = fp * dz + w * s2 + u * p2
        # the electric fields at both, times their dipoles
        a0, a1, a2 = u * dx - t * s0, u * dy - t * s1, u * dz - t * s2
        b[place(k + 7 * ROOM)] = p1 * a2 - p2 * a1
        b[place(k + 8 * ROOM)] = p2 * a0 - p0 * a2
        b[place(k + 9 * ROOM)] = p0 * a1 - p1 * a0
        a0, a1, a2 = w * dx - t * p0, w * dy - t * p1, w * dz - t * p2
        b[place(k + 10 * ROOM)] = s1 * a2 - s2 * a1
        b[place(k + 11 * ROOM)] = s2 * a0 - s0 * a2
        b[place(k + 12 * ROOM)] = s0 * a1 - s1 * a0
        b[place(k + 13 * ROOM)] = ev
        b[place(k + 14 * ROOM)] = qq * f0 + cross * f1 + ps * f2 - pd * sd * f3
    for k in range(n):
        i, j = np.uint32(who[0, place(k)]), np.uint32(who[1, place(k)])
        gx, gy, gz = b[place(k + 4 * ROOM)], b[place(k + 5 * ROOM)], b[place(k + 6 * ROOM)]
        ev, ec = b[place(k + 13 * ROOM)], b[place(k + 14 * ROOM)]
        if not abs(ev + ec) < np.inf or not abs(gx) + abs(gy) + abs(gz) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = who[2, place(k)]
                bad[2] = math.sqrt(b[place(k + 3 * ROOM)])
            continue
        f[0, i] += gx
        f[1, i] += gy
        f[2, i] += gz
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        torque[0, i] += b[place(k + 7 * ROOM)]
        torque[1, i] += b[place(k + 8 * ROOM)]
        torque[2, i] += b[place(k + 9 * ROOM)]
        torque[0, j] += b[place(k + 10 * ROOM)]
        torque[1, j] += b[place(k + 11 * ROOM)]
        torque[2, j] += b[place(k + 12 * ROOM)]
        if ENERGY:
            add(acc, eight(ev, ec, b[place(k)], b[place(k + ROOM)], b[place(k + 2 * ROOM)], gx, gy, gz))
        if PER_ATOM:
            halve(atom_energy, atom_virial, i, j, ev + ec, b[place(k)], b[place(k + ROOM)], b[place(k + 2 * ROOM)], gx, gy, gz)
