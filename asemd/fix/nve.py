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

    @hook
    def initial_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        half = 0.5 * th.dt
        for d in range(3):
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    s.v[d, i] += half * s.inverse_mass[i] * s.f[d, i]
                    s.x[d, i] += th.dt * s.v[d, i]

    @hook
    def final_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        half = 0.5 * th.dt
        for d in range(3):
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    s.v[d, i] += half * s.inverse_mass[i] * s.f[d, i]
