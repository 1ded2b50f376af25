r"""Only the component of the force along a line is left.

.. math:: F_i \leftarrow (F_i \cdot n)\, n

Source: LAMMPS manual, fix lineforce. It acts in minimisation as well.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix, hook
from asemd.words import exactly, number


class LineForce(Fix):
    """Keep the force along a direction.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    direction : sequence of 3 float
        Of any length.

    Raises
    ------
    InputError
        A direction of length 0.
    """

    style = "lineforce"
    minimizes = True
    levels = "every"

    def __init__(self, group: str = "all", direction=(0.0, 0.0, 1.0)):
        super().__init__(group)
        self.direction = np.array(direction, float)
        if self.direction.shape != (3,) or not math.sqrt(self.direction @ self.direction) > 0.0:
            raise InputError(f"fix {self.style}: the direction x y z must not have length 0")

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, [number(w, f"fix {cls.style} direction") for w in exactly(words, 3, f"fix {cls.style}")])

    def to_lammps(self) -> list[str]:
        return [repr(float(d)) for d in self.direction]

    def parameters(self, loop) -> np.ndarray:
        return np.array([float(loop.group_bit(self.group)), *(self.direction / math.sqrt(self.direction @ self.direction))])

    @hook
    def post_force(th, s, p, a):
        bit, nx, ny, nz = np.int32(np.int64(p[0])), p[1], p[2], p[3]
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                along = s.f[0, i] * nx + s.f[1, i] * ny + s.f[2, i] * nz
                s.f[0, i] = along * nx
                s.f[1, i] = along * ny
                s.f[2, i] = along * nz
