r"""Constant energy for ellipsoids that turn: velocity Verlet for positions and angular momenta.

.. math:: L \leftarrow L + \tfrac{\Delta t}{2} T, \qquad \dot q = \tfrac12 \omega q, \quad \omega = I^{-1} L

The orientation, a unit quaternion q, takes a whole step and two half steps at constant angular momentum, whose difference takes the error
of the second order away (Richardson).

Source: LAMMPS manual, fix nve/asphere.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import Fix
from asemd.fix.ellipsoids import check_shapes, ellipsoid_arrays, for_ellipsoids
from asemd.fix.nve_sphere import NVESphere


class NVEAsphere(Fix):
    """Time integration of ellipsoids.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a shape.
    """

    style = "nve/asphere"
    integrates = True
    levels = "every"
    initial_integrate, final_integrate = (staticmethod(for_ellipsoids(h)) for h in (
        NVESphere.initial_integrate, NVESphere.final_integrate))

    @classmethod
    def from_lammps(cls, group, words, session):
        fix = super().from_lammps(group, words, session)
        check_shapes(fix, session.scene.need_system(f"fix {cls.style}"))
        return fix

    def parameters(self, loop) -> np.ndarray:
        check_shapes(self, loop.system, loop.groups[self.group])
        return super().parameters(loop)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        return ellipsoid_arrays(self, loop)
