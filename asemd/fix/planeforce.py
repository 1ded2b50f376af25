r"""The component of the force across a plane goes, so that atoms stay in the planes they are in.

.. math:: F_i \leftarrow F_i - (F_i \cdot n)\, n

Source: LAMMPS manual, fix planeforce. It acts in minimisation as well.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import hook
from asemd.fix.lineforce import LineForce


class PlaneForce(LineForce):
    """Keep the force within planes.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    direction : sequence of 3 float
        The normal of the planes, of any length.

    Raises
    ------
    InputError
        A direction of length 0.
    """

    style = "planeforce"

    @hook
    def post_force(th, s, p, a):
        bit, nx, ny, nz = np.int32(np.int64(p[0])), p[1], p[2], p[3]
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                across = s.f[0, i] * nx + s.f[1, i] * ny + s.f[2, i] * nz
                s.f[0, i] -= across * nx
                s.f[1, i] -= across * ny
                s.f[2, i] -= across * nz
