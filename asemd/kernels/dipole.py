"""Loop over angles between the dipole of an atom and the vector to a second one; pasted by `asemd.kernels.bonded`.

`arrays` holds the dipoles (3, cap) and the torques (3, cap) on them. gamma = atan2(|r x mu|, r . mu). The third atom of the angle is not
used. As in LAMMPS there is no virial.
"""
from __future__ import annotations

import math


def dipole(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    mu, torque = arrays[0], arrays[1]
    energy = 0.0
    for m in range(lo, hi):
        i = items[m, 0]
        torque[0, i] = torque[1, i] = torque[2, i] = 0.0
    for m in range(lo, hi):
        i, j = items[m, 0], items[m, 1]
        ax, ay, az = x[0, j] - x[0, i], x[1, j] - x[1, i], x[2, j] - x[2, i]
        if PERIODIC:
            ax, ay, az = closest(ax, ay, az, cell)
        bx, by, bz = mu[0, i], mu[1, i], mu[2, i]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
        if not (aa > 0.0 and bb > 0.0):
            report(bad, m, math.nan)      # at one place, or no dipole: no angle
            continue
        n = math.sqrt(nx * nx + ny * ny + nz * nz)
        gamma = math.atan2(n, ax * bx + ay * by + az * bz)
        e, slope = evaluate(gamma, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope)):
            report(bad, m, gamma)
            continue
        if n > 0.0:                       # a dipole along the vector is not turned
            w = -slope / n
            tx, ty, tz = w * nx, w * ny, w * nz
            torque[0, i] += tx
            torque[1, i] += ty
            torque[2, i] += tz
            fx, fy, fz = (ay * tz - az * ty) / aa, (az * tx - ax * tz) / aa, (ax * ty - ay * tx) / aa
            push(out, i, -fx, -fy, -fz)
            push(out, j, fx, fy, fz)
        if ENERGY:
            energy += e
        if PER_ATOM:
            for a in (i, j, items[m, 2]):
                share(a, 1.0 / 3.0, e, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
