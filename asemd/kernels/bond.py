"""Loop over bonds. `asemd.kernels.bonded` pastes it behind the constants ENERGY, PER_ATOM, PERIODIC and the functions
`evaluate` (the style) and `closest` (the periodic image); see there for the arguments."""
from __future__ import annotations

import math

import numpy as np


def bond(x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad):
    energy = vxx = vyy = vzz = vxy = vxz = vyz = 0.0
    for m in range(lo, hi):
        i, j = np.uint32(items[m, 0]), np.uint32(items[m, 1])      # no test for negative indices
        dx, dy, dz = x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]
        if PERIODIC:
            dx, dy, dz = closest(dx, dy, dz, cell)
        r = math.sqrt(dx * dx + dy * dy + dz * dz)
        e, slope = evaluate(r, types[m], coeff, arrays)
        if not (math.isfinite(e) and math.isfinite(slope)):
            report(bad, m, r)
            continue
        w = -slope / r if r > 0.0 else 0.0      # at r = 0 the force has no direction
        fx, fy, fz = w * dx, w * dy, w * dz
        push(out, i, fx, fy, fz)
        push(out, j, -fx, -fy, -fz)
        if ENERGY:
            energy += e
            vxx += dx * fx
            vyy += dy * fy
            vzz += dz * fz
            vxy += dx * fy
            vxz += dx * fz
            vyz += dy * fz
        if PER_ATOM:
            for a in (i, j):
                share(a, 0.5, e, dx * fx, dy * fy, dz * fz, dx * fy, dx * fz, dy * fz, atom_energy, atom_virial)
    if ENERGY:
        total(acc, energy, vxx, vyy, vzz, vxy, vxz, vyz)
