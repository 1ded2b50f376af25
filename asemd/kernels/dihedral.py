"""Loop over torsion angles (dihedrals, and impropers in phi or chi); pasted by `asemd.kernels.bonded` like `asemd.kernels.bond`.

With f = x1 - x2, g = x2 - x3, h = x4 - x3, a = f x g, b = h x g the sine is (b x a) . g / |g| and the gradients are multiples of a / a^2
and b / b^2, so that no sine is divided by. Source: Blondel and Karplus, J. Comput. Chem. 17, 1132 (1996).
"""
from __future__ import annotations

import math


def torsion(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        i, j, k, l = items[m, 0], items[m, 1], items[m, 2], items[m, 3]
        fx, fy, fz = x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]
        gx, gy, gz = x[0, j] - x[0, k], x[1, j] - x[1, k], x[2, j] - x[2, k]
        hx, hy, hz = x[0, l] - x[0, k], x[1, l] - x[1, k], x[2, l] - x[2, k]
        if PERIODIC:
            fx, fy, fz = closest(fx, fy, fz, cell)
            gx, gy, gz = closest(gx, gy, gz, cell)
            hx, hy, hz = closest(hx, hy, hz, cell)
        gg = gx * gx + gy * gy + gz * gz
        if not (gg > 0.0 and fx * fx + fy * fy + fz * fz > 0.0 and hx * hx + hy * hy + hz * hz > 0.0):
            report(bad, m, math.nan)      # two atoms at one place: the force diverges
            continue
        ax, ay, az = fy * gz - fz * gy, fz * gx - fx * gz, fx * gy - fy * gx
        bx, by, bz = hy * gz - hz * gy, hz * gx - hx * gz, hx * gy - hy * gx
        aa, bb, g = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, math.sqrt(gg)
        sine = ((by * az - bz * ay) * gx + (bz * ax - bx * az) * gy + (bx * ay - by * ax) * gz) / g
        phi = math.atan2(sine, ax * bx + ay * by + az * bz)
        e, slope = evaluate(phi, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope)):
            report(bad, m, phi)
            continue
        wa = wb = 0.0
        if aa > 0.0 and bb > 0.0:         # with three atoms on a line the force has no direction
            wa, wb = slope / aa, slope / bb
        p = (fx * gx + fy * gy + fz * gz) / g * wa
        q = (hx * gx + hy * gy + hz * gz) / g * wb
        wa, wb = wa * g, -wb * g
        f1x, f1y, f1z = wa * ax, wa * ay, wa * az
        f4x, f4y, f4z = wb * bx, wb * by, wb * bz
        sx, sy, sz = p * ax - q * bx, p * ay - q * by, p * az - q * bz
        f3x, f3y, f3z = sx - f4x, sy - f4y, sz - f4z
        push(out, i, f1x, f1y, f1z)
        push(out, j, -(sx + f1x), -(sy + f1y), -(sz + f1z))
        push(out, k, f3x, f3y, f3z)
        push(out, l, f4x, f4y, f4z)
        if ENERGY or PER_ATOM:            # positions from atom 2: f, -g, h - g
            tx, ty, tz = hx - gx, hy - gy, hz - gz
            pxx, pyy, pzz = fx * f1x - gx * f3x + tx * f4x, fy * f1y - gy * f3y + ty * f4y, fz * f1z - gz * f3z + tz * f4z
            pxy, pxz, pyz = fx * f1y - gx * f3y + tx * f4y, fx * f1z - gx * f3z + tx * f4z, fy * f1z - gy * f3z + ty * f4z
        if ENERGY:
            energy += e
            vxx += pxx
            vyy += pyy
            vzz += pzz
            vxy += pxy
            vxz += pxz
            vyz += pyz
        if PER_ATOM:
            for n in (i, j, k, l):
                share(n, 0.25, e, pxx, pyy, pzz, pxy, pxz, pyz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)
