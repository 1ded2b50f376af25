r"""Atoms with a rotation stand still: no force, no torque.

.. math:: F_i \leftarrow 0, \qquad T_i \leftarrow 0

Source: LAMMPS manual, fix freeze. It needs an atom style with torques. Output: a vector of 3, the total force on the group before.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.threads import reduce_sum


class Freeze(Forcing):
    """Zero force and torque.

    Raises
    ------
    InputError
        At the start of a run: atoms without torques, a second fix freeze.
    """

    style = "freeze"
    minimizes = False
    levels = "every"
    told = size = 3

    def parameters(self, loop) -> np.ndarray:
        if "torque" not in loop.system.extra:
            raise InputError("fix freeze requires atom attribute torque: use an atom style such as sphere")
        if sum(f.style == "freeze" for f in loop.fixes) > 1:
            raise InputError("More than one fix freeze: leave one, for a group of all atoms that stand still")
        return super().parameters(loop)

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        total = np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                for d in range(3):
                    total[d] += s.f[d, i]
                    s.f[d, i] = 0.0
                    s.torque[d, i] = 0.0
        for d in range(3):
            before = reduce_sum(th, total[d])
            if th.tid == 0:
                p[3 + d] = before
