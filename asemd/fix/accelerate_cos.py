r"""A cosine-shaped acceleration along x as a function of z: drives a flow whose amplitude gives the viscosity.

.. math:: a_{ix} = A \cos \frac{2 \pi (z_i - z_{lo})}{L_z}

Source: B. Hess, J. Chem. Phys. 116, 209 (2002); LAMMPS manual, fix accelerate/cos. Units: distance/time^2.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix, hook
from asemd.words import exactly, number


class AccelerateCos(Fix):
    """Periodic acceleration.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    acceleration : float
        The amplitude A, in distance units of the scene over its time units squared.

    Raises
    ------
    InputError
        At the start of a run, in two dimensions.
    """

    style = "accelerate/cos"

    def __init__(self, group: str = "all", acceleration: float = 0.0):
        super().__init__(group)
        self.acceleration = acceleration

    @classmethod
    def from_lammps(cls, group, words, session):
        if session.scene.system.dimension == 2:
            raise InputError("fix accelerate/cos needs a system in three dimensions")
        return cls(group, number(exactly(words, 1, "fix accelerate/cos")[0], "fix accelerate/cos"))

    def to_lammps(self) -> list[str]:
        return [repr(float(self.acceleration))]

    def parameters(self, loop) -> np.ndarray:
        if loop.system.dimension == 2:
            raise InputError("fix accelerate/cos needs a system in three dimensions")
        return np.array([loop.group_bit(self.group), self.acceleration * loop.units.mvv2e])

    @hook
    def post_force(th, s, p, a):
        bit, mine, low = np.int32(np.int64(p[0])), slice(th.lo, th.hi), s.box.origin[2]
        wave = 2.0 * math.pi / s.box.vectors[2, 2]
        mask, mass, z, f = s.mask[mine], s.mass[mine], s.x[2, mine], s.f[0, mine]
        for i in range(f.size):
            if mask[i] & bit != 0:
                f[i] += p[1] * mass[i] * math.cos(wave * (z[i] - low))
