r"""Constant energy: velocity Verlet.

.. math:: v \leftarrow v + \tfrac{\Delta t}{2} \frac{F}{m}, \quad x \leftarrow x + \Delta t\, v, \quad \text{new } F, \quad
          v \leftarrow v + \tfrac{\Delta t}{2} \frac{F}{m}

Source: W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76, 637 (1982); LAMMPS manual, fix nve.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import Fix, hook


class NVE(Fix):
    """Time integration without thermostat."""

    style = "nve"
    integrates = True
    levels = "every"

    @hook
    def initial_integrate(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            x, v, f = s.x[d, mine], s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]
                    x[i] += th.dt * v[i]

    @hook
    def final_integrate(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]

    @hook
    def final_initial(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            x, v, f = s.x[d, mine], s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    kick = half * inverse_mass[i] * f[i]
                    v[i] += kick
                    v[i] += kick
                    x[i] += th.dt * v[i]
