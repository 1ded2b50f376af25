r"""Friction: a force against the velocity.

.. math:: F_i \leftarrow F_i - \gamma_t\, v_i

with :math:`\gamma` scaled by atom type. It takes energy out of a system that relaxes.

Source: LAMMPS manual, fix viscous. Units: ``gamma`` in force/velocity units. It acts in minimisation as well, where velocities are 0.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.words import number, take, whole


class Viscous(Forcing):
    """Friction.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    gamma : float
        Friction coefficient, force/velocity units of the scene.
    scale : mapping of int to float, optional
        Factors by atom type; 1 where none is given.
    """

    style = "viscous"

    def __init__(self, group: str = "all", gamma: float = 0.0, scale=None):
        super().__init__(group)
        self.gamma, self.scale = gamma, dict(scale or {})

    @classmethod
    def from_lammps(cls, group, words, session):
        gamma, scale, words = number(take(words, 1, "fix viscous")[0], "fix viscous gamma"), {}, words[1:]
        while words:
            if words[0] != "scale":
                raise InputError(f"fix viscous: unknown keyword {words[0]!r}, there is scale type ratio")
            kind, ratio = take(words[1:], 2, "fix viscous scale")
            kind = whole(kind, "fix viscous scale type")
            if not 1 <= kind <= session.scene.system.counts["ntypes"]:
                raise InputError(f"fix viscous scale: there is no atom type {kind}")
            scale[kind], words = number(ratio, "fix viscous scale ratio"), words[3:]
        return cls(group, gamma, scale)

    def to_lammps(self) -> list[str]:
        return [repr(self.gamma), *(w for kind, ratio in self.scale.items() for w in ("scale", str(kind), repr(ratio)))]

    def numbers(self, loop) -> list[float]:
        return [self.gamma * self.scale.get(kind, 1.0) for kind in range(len(loop.system.mass))]

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                gamma = p[3 + s.type[i]]
                for d in range(3):
                    s.f[d, i] -= gamma * s.v[d, i]
