r"""A spring between the centre of mass of a group and a point, or that of another group.

.. math:: E = \tfrac12 K (R - R_0)^2, \qquad F_i = -K (R - R_0) \frac{m_i}{M} \hat R

with R the distance of the centre from the point ``x y z`` (``tether``), or of the centre of the second group from the point ``x y z`` away
from that of the first (``couple``); a coordinate NULL (None) does not count. Positions are unwrapped.

Source: LAMMPS manual, fix spring. Units: ``K`` in force/distance units. Output: a scalar, the energy; a vector of 4, the force on the group
and its size, negative where it repels.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing, centre_of_mass, unwrapped
from asemd.words import choice, exactly, number, take


class Spring(Forcing):
    """A spring at the centre of mass.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    k : float
        Spring constant, force/distance units of the scene.
    point : sequence of 3 of float or None
        The point, or the rest position of the second group relative to the first; None: that direction does not count.
    length : float
        Length of the spring at rest, distance units.
    couple : str
        Name of the second group; empty: the spring ends at the point.

    Raises
    ------
    InputError
        A negative length, the same group at both ends.
    """

    style = "spring"
    minimizes = True
    told, size, first = 5, 4, 4
    modifies = ("energy",)
    conservative = True

    def __init__(self, group: str = "all", k: float = 1.0, point=(0.0, 0.0, 0.0), length: float = 0.0, couple: str = ""):
        super().__init__(group, point)
        if len(self.values) != 3:
            raise InputError(f"fix spring: a point has 3 coordinates, got {len(self.values)}")
        if length < 0.0:
            raise InputError(f"fix spring: R0 must not be negative, got {length:g}")
        if couple == group:
            raise InputError("fix spring: Two groups cannot be the same in fix spring couple")
        self.k, self.length, self.couple = k, length, couple

    @classmethod
    def from_lammps(cls, group, words, session):
        kind = choice(take(words, 1, "fix spring")[0], ("tether", "couple"), "fix spring")
        what, other = f"fix spring {kind}", ""
        rest = exactly(words[1:], 5 + (kind == "couple"), what)
        if kind == "couple":
            other, rest = rest[0], rest[1:]
            session.scene.groups.mask(other, what)
        point = [None if w == "NULL" else number(w, f"{what} point") for w in rest[1:4]]
        return cls(group, number(rest[0], f"{what} K"), point, number(rest[4], f"{what} R0"), other)

    def to_lammps(self) -> list[str]:
        head = ["couple", self.couple] if self.couple else ["tether"]
        return [*head, repr(self.k), *self.value_words(), repr(self.length)]

    def numbers(self, loop) -> list[float]:
        other = loop.group_bit(self.couple) if self.couple else 0.0
        return [*(float(v is not None) for v in self.values), self.k, self.length, other]

    @hook(uses=[unwrapped, centre_of_mass])
    def post_force(th, s, p, a):
        bit, other = np.int32(np.int64(p[0])), np.int32(np.int64(p[16]))
        mass, x, y, z = centre_of_mass(th, s, bit)
        mass2 = 0.0
        if other != 0:
            mass2, x2, y2, z2 = centre_of_mass(th, s, other)
            x, y, z = x2 - x, y2 - y, z2 - z
        dx, dy, dz = p[11] * (x - p[8]), p[12] * (y - p[9]), p[13] * (z - p[10])
        r = max(math.sqrt(dx * dx + dy * dy + dz * dz), 1e-10)
        dr = r - p[15]
        pull = p[14] * dr / r
        fx, fy, fz = pull * dx, pull * dy, pull * dz
        if other == 0:
            fx, fy, fz = -fx, -fy, -fz
        if th.tid == 0:
            size = math.sqrt(fx * fx + fy * fy + fz * fz)
            p[3], p[4], p[5], p[6], p[7] = 0.5 * p[14] * dr * dr, fx, fy, fz, (size if dr >= 0.0 else -size)
        part = 1.0 / mass if mass > 0.0 else 0.0
        part2 = 1.0 / mass2 if mass2 > 0.0 else 0.0
        for i in range(th.lo, th.hi):
            share = 0.0
            if s.mask[i] & bit != 0:
                share += s.mass[i] * part
            if s.mask[i] & other != 0:
                share -= s.mass[i] * part2
            if share != 0.0:
                s.f[0, i] += fx * share
                s.f[1, i] += fy * share
                s.f[2, i] += fz * share

    def scalar(self) -> float:
        """Energy of the spring, energy units."""
        return float(self.p[3])
