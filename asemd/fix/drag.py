r"""Drag atoms to a point by a force of constant size.

.. math:: F_i \leftarrow F_i - f_{mag} \frac{r_i - r_0}{|r_i - r_0|}

for atoms farther than delta from it, by the closest image; a coordinate NULL (None) does not count.

Source: LAMMPS manual, fix drag. Units: force, distance. Output: a vector of 3, the total force of the drag.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.kernels.image import closest_general
from asemd.kernels.threads import reduce_sum
from asemd.words import exactly, number


class Drag(Forcing):
    """Pull atoms to a point.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    point : sequence of 3 of float or None
        Where to, distance units of the scene; None: that direction does not count.
    force : float
        Size of the force on each atom, force units.
    delta : float
        Atoms closer than this are left alone, distance units.
    """

    style = "drag"
    minimizes = False
    told = size = 3

    def __init__(self, group: str = "all", point=(0.0, 0.0, 0.0), force: float = 0.0, delta: float = 0.0):
        super().__init__(group, point)
        if len(self.values) != 3:
            raise InputError(f"fix drag: a point has 3 coordinates, got {len(self.values)}")
        self.force, self.delta = force, delta

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix drag"
        *point, force, delta = exactly(words, 5, "fix drag x y z fmag delta")
        point = [None if w == "NULL" else number(w, f"{what} point") for w in point]
        return cls(group, point, number(force, f"{what} fmag"), number(delta, f"{what} delta"))

    def to_lammps(self) -> list[str]:
        return [*self.value_words(), repr(self.force), repr(self.delta)]

    def numbers(self, loop) -> list[float]:
        return [*(float(v is not None) for v in self.values), self.force, self.delta]

    @hook(uses=[closest_general])
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        total = np.zeros(3)
        d = np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                for k in range(3):
                    d[k] = p[9 + k] * (s.x[k, i] - p[6 + k])
                d[0], d[1], d[2] = closest_general(d[0], d[1], d[2], s.box.cell)
                r = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
                if r > p[13]:
                    for k in range(3):
                        push = p[12] * d[k] / r
                        s.f[k, i] -= push
                        total[k] -= push
        for k in range(3):
            part = reduce_sum(th, total[k])
            if th.tid == 0:
                p[3 + k] = part
