"""Loop over out-of-plane angles; pasted by `asemd.kernels.bonded` like `asemd.kernels.bond` (phi and chi: `asemd.kernels.dihedral`).

Atom 1 (I) is the centre, u = x2 - x1, v = x3 - x1, l = x4 - x1, n = u x v. omega is the angle of l with the plane of u and v, counted
from the side away from u and v, so that it passes 90 degrees when atom 4 leans over to their side.
"""
from __future__ import annotations

import math


def out_of_plane(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        i, j, k, l = items[m, 0], items[m, 1], items[m, 2], items[m, 3]
        ux, uy, uz = x[0, j] - x[0, i], x[1, j] - x[1, i], x[2, j] - x[2, i]
        vx, vy, vz = x[0, k] - x[0, i], x[1, k] - x[1, i], x[2, k] - x[2, i]
        lx, ly, lz = x[0, l] - x[0, i], x[1, l] - x[1, i], x[2, l] - x[2, i]
        if PERIODIC:
            ux, uy, uz = closest(ux, uy, uz, cell)
            vx, vy, vz = closest(vx, vy, vz, cell)
            lx, ly, lz = closest(lx, ly, lz, cell)
        uu, vv, ll = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, lx * lx + ly * ly + lz * lz
        if not (uu > 0.0 and vv > 0.0 and ll > 0.0):
            report(bad, m, math.nan)      # two atoms at one place: the force diverges
            continue
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        n = math.sqrt(nx * nx + ny * ny + nz * nz)
        w = 1.0 / n if n > 0.0 else 0.0   # with I, J, K on a line there is no plane: no force
        nx, ny, nz = nx * w, ny * w, nz * w
        qx, qy, qz = ny * lz - nz * ly, nz * lx - nx * lz, nx * ly - ny * lx
        height, base = nx * lx + ny * ly + nz * lz, math.sqrt(qx * qx + qy * qy + qz * qz)
        side = (lx * ux + ly * uy + lz * uz) / math.sqrt(uu) + (lx * vx + ly * vy + lz * vz) / math.sqrt(vv)
        turn = -1.0 if side > 0.0 else 1.0
        omega = math.atan2(height, turn * base)
        e, slope = evaluate(omega, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope)):
            report(bad, m, omega)
            continue
        # (q x n) / base is the unit vector along the part of l in the plane
        s = 1.0 / base if base > 0.0 and n > 0.0 else 0.0
        px, py, pz = (qy * nz - qz * ny) * s, (qz * nx - qx * nz) * s, (qx * ny - qy * nx) * s
        c = -slope * turn
        cl, sl = c * base / ll * (1.0 if s > 0.0 else 0.0), c * height / ll
        f4x, f4y, f4z = cl * nx - sl * px, cl * ny - sl * py, cl * nz - sl * pz
        # along n only: (v x p) . n and (p x u) . n
        c *= w
        c2 = c * ((vy * pz - vz * py) * nx + (vz * px - vx * pz) * ny + (vx * py - vy * px) * nz)
        c3 = c * ((py * uz - pz * uy) * nx + (pz * ux - px * uz) * ny + (px * uy - py * ux) * nz)
        f2x, f2y, f2z = c2 * nx, c2 * ny, c2 * nz
        f3x, f3y, f3z = c3 * nx, c3 * ny, c3 * nz
        push(out, i, -(f2x + f3x + f4x), -(f2y + f3y + f4y), -(f2z + f3z + f4z))
        push(out, j, f2x, f2y, f2z)
        push(out, k, f3x, f3y, f3z)
        push(out, l, f4x, f4y, f4z)
        if ENERGY or PER_ATOM:
            pxx, pyy, pzz = ux * f2x + vx * f3x + lx * f4x, uy * f2y + vy * f3y + ly * f4y, uz * f2z + vz * f3z + lz * f4z
            pxy, pxz, pyz = ux * f2y + vx * f3y + lx * f4y, ux * f2z + vx * f3z + lx * f4z, uy * f2z + vy * f3z + ly * f4z
        if ENERGY:
            energy += e
            vxx += pxx
            vyy += pyy
            vzz += pzz
            vxy += pxy
            vxz += pxz
            vyz += pyz
        if PER_ATOM:
            for a in (i, j, k, l):
                share(a, 0.25, e, pxx, pyy, pzz, pxy, pxz, pyz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)
