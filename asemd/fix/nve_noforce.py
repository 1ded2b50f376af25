r"""Positions follow velocities, which no force changes.

.. math:: r_i \leftarrow r_i + \Delta t\, v_i

For walls and pistons that move at their own speed.

Source: LAMMPS manual, fix nve/noforce.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import Fix, hook


class NVENoForce(Fix):
    """Straight motion."""

    style = "nve/noforce"
    integrates = True
    levels = "every"

    @hook
    def initial_integrate(th, s, p, a):
        bit, mine = np.int32(np.int64(p[0])), slice(th.lo, th.hi)
        mask = s.mask[mine]
        for d in range(3):
            x, v = s.x[d, mine], s.v[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    x[i] += th.dt * v[i]

    @hook
    def final_integrate(th, s, p, a):
        return
