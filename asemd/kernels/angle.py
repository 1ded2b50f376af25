"""Loop over angles; pasted by `asemd.kernels.bonded` like `asemd.kernels.bond`. R12, R32, R13 say which distances the style takes.

theta = atan2(|a x b|, a . b) and its gradient (a x n) / (a^2 |n|), n = a x b, keep all digits from 0 to 180 degrees.
"""
from __future__ import annotations

import math


def angle(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        i, j, k = items[m, 0], items[m, 1], items[m, 2]
        ax, ay, az = x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]
        bx, by, bz = x[0, k] - x[0, j], x[1, k] - x[1, j], x[2, k] - x[2, j]
        if PERIODIC:
            ax, ay, az = closest(ax, ay, az, cell)
            bx, by, bz = closest(bx, by, bz, cell)
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
        n = math.sqrt(nx * nx + ny * ny + nz * nz)
        theta = math.atan2(n, ax * bx + ay * by + az * bz)
        if not (aa > 0.0 and bb > 0.0):
            report(bad, m, math.nan)      # two atoms at one place: the force diverges
            continue
        r12 = math.sqrt(aa) if R12 else 0.0
        r32 = math.sqrt(bb) if R32 else 0.0
        cx, cy, cz = ax - bx, ay - by, az - bz
        r13 = math.sqrt(cx * cx + cy * cy + cz * cz) if R13 else 0.0
        e, slope, slope12, slope32, slope13 = evaluate(theta, r12, r32, r13, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope + slope12 + slope32 + slope13)):
            report(bad, m, theta)
            continue
        wa = wb = 0.0
        if n > 0.0:                       # on a straight line the force has no direction
            wa, wb = -slope / (aa * n), -slope / (bb * n)
        fx, fy, fz = wa * (ay * nz - az * ny), wa * (az * nx - ax * nz), wa * (ax * ny - ay * nx)
        gx, gy, gz = wb * (ny * bz - nz * by), wb * (nz * bx - nx * bz), wb * (nx * by - ny * bx)
        if R12:
            w = -slope12 / r12
            fx, fy, fz = fx + w * ax, fy + w * ay, fz + w * az
        if R32:
            w = -slope32 / r32
            gx, gy, gz = gx + w * bx, gy + w * by, gz + w * bz
        if R13:
            w = -slope13 / r13 if r13 > 0.0 else 0.0
            fx, fy, fz = fx + w * cx, fy + w * cy, fz + w * cz
            gx, gy, gz = gx - w * cx, gy - w * cy, gz - w * cz
        push(out, i, fx, fy, fz)
        push(out, j, -(fx + gx), -(fy + gy), -(fz + gz))
        push(out, k, gx, gy, gz)
        if ENERGY or PER_ATOM:
            pxx, pyy, pzz = ax * fx + bx * gx, ay * fy + by * gy, az * fz + bz * gz
            pxy, pxz, pyz = ax * fy + bx * gy, ax * fz + bx * gz, ay * fz + by * gz
        if ENERGY:
            energy += e
            vxx += pxx
            vyy += pyy
            vzz += pzz
            vxy += pxy
            vxz += pxz
            vyz += pyz
        if PER_ATOM:
            for a in (i, j, k):
                share(a, 1.0 / 3.0, e, pxx, pyy, pzz, pxy, pxz, pyz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)
