"""Loops over items whose energy is a function of vectors; pasted by `asemd.kernels.bonded` like `asemd.kernels.bond`.

a, b, c are the vectors from the atom CENTRE to the atoms A, B, C of the item (places 0 to 3).
"""
from __future__ import annotations

import math


def order(style) -> list[int]:
    """Places of the centre and of the other atoms in an item of a style."""
    centre = style.centre - 1
    return [centre] + [k for k in range(3 if style.category == "angle" else 4) if k != centre]


def three(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        o, i, j = items[m, CENTRE], items[m, A], items[m, B]
        ax, ay, az = x[0, i] - x[0, o], x[1, i] - x[1, o], x[2, i] - x[2, o]
        bx, by, bz = x[0, j] - x[0, o], x[1, j] - x[1, o], x[2, j] - x[2, o]
        if PERIODIC:
            ax, ay, az = closest(ax, ay, az, cell)
            bx, by, bz = closest(bx, by, bz, cell)
        e, gax, gay, gaz, gbx, gby, gbz = evaluate(ax, ay, az, bx, by, bz, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(gax + gay + gaz + gbx + gby + gbz)):
            report(bad, m, 0.0 if math.isfinite(ax + ay + az + bx + by + bz) else math.nan)
            continue
        push(out, i, -gax, -gay, -gaz)
        push(out, j, -gbx, -gby, -gbz)
        push(out, o, gax + gbx, gay + gby, gaz + gbz)
        if ENERGY or PER_ATOM:
            pxx, pyy, pzz = -(ax * gax + bx * gbx), -(ay * gay + by * gby), -(az * gaz + bz * gbz)
            pxy, pxz, pyz = -(ax * gay + bx * gby), -(ax * gaz + bx * gbz), -(ay * gaz + by * gbz)
        if ENERGY:
            energy += e
            vxx += pxx
            vyy += pyy
            vzz += pzz
            vxy += pxy
            vxz += pxz
            vyz += pyz
        if PER_ATOM:
            for n in (i, j, o):
                share(n, 1.0 / 3.0, e, pxx, pyy, pzz, pxy, pxz, pyz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)


def four(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        o, i, j, k = items[m, CENTRE], items[m, A], items[m, B], items[m, C]
        ax, ay, az = x[0, i] - x[0, o], x[1, i] - x[1, o], x[2, i] - x[2, o]
        bx, by, bz = x[0, j] - x[0, o], x[1, j] - x[1, o], x[2, j] - x[2, o]
        cx, cy, cz = x[0, k] - x[0, o], x[1, k] - x[1, o], x[2, k] - x[2, o]
        if PERIODIC:
            ax, ay, az = closest(ax, ay, az, cell)
            bx, by, bz = closest(bx, by, bz, cell)
            cx, cy, cz = closest(cx, cy, cz, cell)
        e, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = evaluate(ax, ay, az, bx, by, bz, cx, cy, cz, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(gax + gay + gaz + gbx + gby + gbz + gcx + gcy + gcz)):
            report(bad, m, 0.0 if math.isfinite(ax + ay + az + bx + by + bz + cx + cy + cz) else math.nan)
            continue
        push(out, i, -gax, -gay, -gaz)
        push(out, j, -gbx, -gby, -gbz)
        push(out, k, -gcx, -gcy, -gcz)
        push(out, o, gax + gbx + gcx, gay + gby + gcy, gaz + gbz + gcz)
        if ENERGY or PER_ATOM:
            pxx, pyy, pzz = -(ax * gax + bx * gbx + cx * gcx), -(ay * gay + by * gby + cy * gcy), -(az * gaz + bz * gbz + cz * gcz)
            pxy, pxz, pyz = -(ax * gay + bx * gby + cx * gcy), -(ax * gaz + bx * gbz + cx * gcz), -(ay * gaz + by * gbz + cy * gcz)
        if ENERGY:
            energy += e
            vxx += pxx
            vyy += pyy
            vzz += pzz
            vxy += pxy
            vxz += pxz
            vyz += pyz
        if PER_ATOM:
            for n in (i, j, k, o):
                share(n, 0.25, e, pxx, pyy, pzz, pxy, pxz, pyz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)
