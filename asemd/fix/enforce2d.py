r"""Two dimensions: velocity and force along z are zero, and spheres turn about z only.

Source: LAMMPS manual, fix enforce2d.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix, hook


class Enforce2D(Fix):
    """Keep atoms in the plane they are in.

    Raises
    ------
    InputError
        At the start of a run, if the system has three dimensions.
    """

    style = "enforce2d"
    minimizes = True
    levels = "every"

    def parameters(self, loop) -> np.ndarray:
        if loop.system.dimension != 2:
            raise InputError("fix enforce2d is for systems of two dimensions; say dimension 2 before the box is created")
        return np.array([loop.group_bit(self.group), *(name in loop.system.extra for name in ("omega", "angmom"))], float)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Angular velocities of spheres, angular momenta of ellipsoids."""
        return tuple(loop.system.extra.get(name, np.zeros((1, 3))) for name in ("omega", "angmom"))

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                s.v[2, i] = 0.0
                s.f[2, i] = 0.0
                for k in range(2):
                    if p[1 + k] != 0.0:
                        for d in range(2):
                            a[k][s.row[i], d] = 0.0
                            s.torque[d, i] = 0.0
