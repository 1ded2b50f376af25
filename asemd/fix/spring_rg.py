r"""A spring on the radius of gyration of a group.

.. math:: E = K (R_G - R_{G0})^2, \qquad F_i = -2 K \left(1 - \frac{R_{G0}}{R_G}\right) \frac{m_i}{M} (r_i - r_{cm})

Source: LAMMPS manual, fix spring/rg. Units: ``K`` in force/distance units. Output: a scalar, the reference radius.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.fix import hook
from asemd.fix.forcing import Forcing, centre_of_mass, unwrapped
from asemd.kernels.threads import reduce_sum
from asemd.words import exactly, number


class SpringRG(Forcing):
    """A spring on the radius of gyration.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    k : float
        Spring constant, force/distance units of the scene.
    radius : float, optional
        Reference radius, distance units; None: that at the start of the first run.
    """

    style = "spring/rg"
    minimizes = False
    extensive = False

    def __init__(self, group: str = "all", k: float = 1.0, radius: float | None = None):
        super().__init__(group)
        self.k, self.radius, self.reference = k, radius, radius

    @classmethod
    def from_lammps(cls, group, words, session):
        k, radius = exactly(words, 2, "fix spring/rg K RG0")
        return cls(group, number(k, "fix spring/rg K"), None if radius == "NULL" else number(radius, "fix spring/rg RG0"))

    def to_lammps(self) -> list[str]:
        return [repr(self.k), "NULL" if self.radius is None else repr(self.radius)]

    def numbers(self, loop) -> list[float]:
        if self.reference is None:
            system, mask = loop.system, loop.groups[self.group]
            m, x = system.atom_masses()[mask], system.box.unwrap(system.x, system.image)[mask]
            d = x - m @ x / m.sum()
            self.reference = math.sqrt(m @ (d * d).sum(axis=1) / m.sum())
        return [self.k, self.reference]

    @hook(uses=[unwrapped, centre_of_mass])
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        mass, x, y, z = centre_of_mass(th, s, bit)
        square = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                dx, dy, dz = unwrapped(s, i, 0) - x, unwrapped(s, i, 1) - y, unwrapped(s, i, 2) - z
                square += s.mass[i] * (dx * dx + dy * dy + dz * dz)
        square = reduce_sum(th, square)
        if square > 0.0:
            pull = 2.0 * p[3] * (1.0 - p[4] / math.sqrt(square / mass)) / mass
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    share = pull * s.mass[i]
                    s.f[0, i] -= share * (unwrapped(s, i, 0) - x)
                    s.f[1, i] -= share * (unwrapped(s, i, 1) - y)
                    s.f[2, i] -= share * (unwrapped(s, i, 2) - z)

    def scalar(self) -> float:
        """The reference radius, distance units."""
        return float(self.reference or 0.0)

    def state(self) -> dict:
        """The reference radius."""
        return {"radius": self.scalar()}

    def restore(self, state: dict) -> None:
        self.reference = state["radius"]
