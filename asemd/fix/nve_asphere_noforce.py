r"""Positions and orientations of ellipsoids at constant velocity and angular momentum: forces and torques do not act.

.. math:: r \leftarrow r + \Delta t\, v, \qquad \dot q = \tfrac12 \omega q, \quad \omega = I^{-1} L

Orientations turn as in `asemd.fix.nve_asphere`.

Source: LAMMPS manual, fix nve/asphere/noforce.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import hook
from asemd.fix.ellipsoids import USES, turn_along
from asemd.fix.nve_asphere import NVEAsphere
from asemd.fix.nve_noforce import NVENoForce
from asemd.fix.spheres import move_spheres


class NVEAsphereNoforce(NVEAsphere):
    """Motion of ellipsoids without forces.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a shape.
    """

    style = "nve/asphere/noforce"
    final_integrate = staticmethod(NVENoForce.final_integrate)

    @hook(uses=[*USES, move_spheres])
    def initial_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        move_spheres(th, s, bit)
        turn_along(th, s, bit, a[0], a[1], a[2], a[3])
