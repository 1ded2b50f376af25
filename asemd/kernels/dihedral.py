"""Loop over torsion angles (dihedrals, and impropers in phi or chi); pasted by `asemd.kernels.bonded` like `asemd.kernels.bond`.
R12, R23, R34, THETA1, THETA2 say which lengths and angles the style takes besides, ARMS whether it takes any, CHI that it takes the size of
phi, STRAIGHT that it has an energy of its own for three atoms on a line, where phi is not defined; else that of 90 degrees counts.

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
        sine = ((by * az - bz * ay) * gx + (bz * ax - bx * az) * gy + (bx * ay - by * ax) * gz) / g + 0.0     # never -0.0: trans is +pi
        line = not (aa > 0.0 and bb > 0.0)
        phi = 0.5 * math.pi if line else math.atan2(sine, ax * bx + ay * by + az * bz)
        r12 = math.sqrt(fx * fx + fy * fy + fz * fz) if R12 else 0.0
        r34 = math.sqrt(hx * hx + hy * hy + hz * hz) if R34 else 0.0
        theta1 = math.atan2(math.sqrt(aa), -(fx * gx + fy * gy + fz * gz)) if THETA1 else 0.0
        theta2 = math.atan2(math.sqrt(bb), gx * hx + gy * hy + gz * hz) if THETA2 else 0.0
        e, slope, slope12, slope23, slope34, bend1, bend2 = evaluate(phi, r12, g, r34, theta1, theta2, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope + slope12 + slope23 + slope34 + bend1 + bend2)):
            report(bad, m, phi)
            continue
        if STRAIGHT and line:
            e = straight(types[m], coeff, arrays)
        if line or CHI and sine == 0.0:   # three atoms on a line, or the size of an angle in the plane: the force has no direction
            wa = wb = 0.0
        else:
            wa, wb = slope / aa, slope / bb
        p = (fx * gx + fy * gy + fz * gz) / g * wa
        q = (hx * gx + hy * gy + hz * gz) / g * wb
        wa, wb = wa * g, -wb * g
        f1x, f1y, f1z = wa * ax, wa * ay, wa * az
        f4x, f4y, f4z = wb * bx, wb * by, wb * bz
        sx, sy, sz = p * ax - q * bx, p * ay - q * by, p * az - q * bz
        f3x, f3y, f3z = sx - f4x, sy - f4y, sz - f4z
        f2x, f2y, f2z = -(sx + f1x), -(sy + f1y), -(sz + f1z)
        if ARMS:
            # p1, p3 act on the ends of the angle 1-2-3 and q2, q4 on those of 2-3-4; bond forces go along f, g, h
            p1x = p1y = p1z = p3x = p3y = p3z = q2x = q2y = q2z = q4x = q4y = q4z = 0.0
            if THETA1:
                n = math.sqrt(aa)
                u, w = 0.0, 0.0           # on a straight line the force has no direction
                if n > 0.0:
                    u, w = bend1 / n / (fx * fx + fy * fy + fz * fz), bend1 / n / gg
                p1x, p1y, p1z = u * (fy * az - fz * ay), u * (fz * ax - fx * az), u * (fx * ay - fy * ax)
                p3x, p3y, p3z = w * (gy * az - gz * ay), w * (gz * ax - gx * az), w * (gx * ay - gy * ax)
            if THETA2:
                n = math.sqrt(bb)
                u, w = 0.0, 0.0
                if n > 0.0:
                    u, w = bend2 / n / gg, bend2 / n / (hx * hx + hy * hy + hz * hz)
                q2x, q2y, q2z = u * (gy * bz - gz * by), u * (gz * bx - gx * bz), u * (gx * by - gy * bx)
                q4x, q4y, q4z = -w * (hy * bz - hz * by), -w * (hz * bx - hx * bz), -w * (hx * by - hy * bx)
            if R12:
                w = -slope12 / r12
                p1x, p1y, p1z = p1x + w * fx, p1y + w * fy, p1z + w * fz
            if R23:
                w = -slope23 / g
                q2x, q2y, q2z = q2x + w * gx, q2y + w * gy, q2z + w * gz
            if R34:
                w = -slope34 / r34
                q4x, q4y, q4z = q4x + w * hx, q4y + w * hy, q4z + w * hz
            f1x, f1y, f1z = f1x + p1x, f1y + p1y, f1z + p1z
            f4x, f4y, f4z = f4x + q4x, f4y + q4y, f4z + q4z
            f2x, f2y, f2z = f2x + (q2x - p1x - p3x), f2y + (q2y - p1y - p3y), f2z + (q2z - p1z - p3z)
            f3x, f3y, f3z = f3x + (p3x - q2x - q4x), f3y + (p3y - q2y - q4y), f3z + (p3z - q2z - q4z)
        push(out, i, f1x, f1y, f1z)
        push(out, j, f2x, f2y, f2z)
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
