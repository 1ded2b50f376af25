"""Forces of dissipative particle dynamics: conservative, friction along and across the line of centres, and noise, for each pair of a list.

Random numbers come one after the other from the stream of each thread (`asemd.kernels.marsaglia`), in the order of the list.
Constants of the generated module: ENERGY, PER_ATOM, ACROSS (friction and noise across the line of centres, with exponents).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.marsaglia import gaussian
from asemd.kernels.pair_sums import add, eight, halve

ENERGY = PER_ATOM = ACROSS = False


def noisy_forces(th, x, f, v, type_of, mask, pair_i, pair_j, code, shifts, images, rates, group, weight, lo, hi, rows, stream, before,
                 control, acc, atom_energy, atom_virial):
    """Pairs lo..hi-1: forces added to `f`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and `atom_virial (6, cap)`.

    `rows`: cut^2, 0, a0, cut, gamma, gamma across, exponents along and across. `control`: dt, steps of the run up to now and in all, for
    calls outside the time loop; 2 kT at the beginning and at the end of the run, factor of all forces. `before` becomes what `stream` was.
    Images (`images (m, 3)` in cell vectors) of the atoms whose mask has the bit `group` move with the box: `rates[3:9]` are those of its
    lengths x y z and of its tilts yz xz xy.
    """
    for k in range(len(stream)):
        before[k] = stream[k]
    dt, gone, steps = control[0], control[1], control[2]
    if th.dt > 0.0:
        dt, gone, steps = th.dt, float(th.step - th.begin), float(th.end - th.begin)
    part = min(gone / steps, 1.0) if steps > 0.0 else 0.0
    heat = control[3] + part * (control[4] - control[3])
    scale = 1.0 / math.sqrt(dt)
    factor = control[5]
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
        if r2 >= rows[0, ti, tj]:
            continue
        r = math.sqrt(r2)
        if r < 1e-10:
            continue
        w = factor * weight[kind]
        root = factor * math.sqrt(weight[kind])
        rinv = 1.0 / r
        ux = v[0, i] - v[0, j]
        uy = v[1, i] - v[1, j]
        uz = v[2, i] - v[2, j]
        if mask[j] & group:
            na, nb, nc = images[image, 0], images[image, 1], images[image, 2]
            ux -= na * rates[3] + nb * rates[8] + nc * rates[7]
            uy -= nb * rates[4] + nc * rates[6]
            uz -= nc * rates[5]
        along = (dx * ux + dy * uy + dz * uz) * rinv
        near = 1.0 - r / rows[3, ti, tj]
        a0 = rows[2, ti, tj]
        gamma = rows[4, ti, tj]
        wp = near
        if ACROSS:
            wp = math.pow(near, rows[6, ti, tj])
        noise = gaussian(stream)
        push = (w * (a0 * near - gamma * wp * wp * along) + root * math.sqrt(heat * gamma) * wp * noise * scale) * rinv
        gx = push * dx
        gy = push * dy
        gz = push * dz
        if ACROSS:
            nx = gaussian(stream)
            ny = gaussian(stream)
            nz = gaussian(stream)
            wt = math.pow(near, rows[7, ti, tj])
            drag = w * rows[5, ti, tj] * wt * wt
            kick = root * math.sqrt(heat * rows[5, ti, tj]) * wt * scale
            line = (dx * nx + dy * ny + dz * nz) * rinv
            gx += kick * (nx - line * dx * rinv) - drag * (ux - along * dx * rinv)
            gy += kick * (ny - line * dy * rinv) - drag * (uy - along * dy * rinv)
            gz += kick * (nz - line * dz * rinv) - drag * (uz - along * dz * rinv)
        f[0, i] += gx
        f[1, i] += gy
        f[2, i] += gz
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        e = 0.5 * w * a0 * rows[3, ti, tj] * near * near
        if ENERGY:
            add(acc, eight(e, 0.0, dx, dy, dz, gx, gy, gz))
        if PER_ATOM:
            halve(atom_energy, atom_virial, i, j, e, dx, dy, dz, gx, gy, gz)
