r"""A constant acceleration of all atoms.

.. math:: F_i \leftarrow F_i + m_i\, g\, n, \qquad E = -\sum_i m_i\, g\, n \cdot r_i

The direction n: ``chute a`` is down a plane inclined by a degrees from the horizontal (in x), ``spherical phi theta`` by the angle from x
and from z, ``vector x y z``. The magnitude and all of these numbers may be variables of style equal.

Source: LAMMPS manual, fix gravity. Units: ``magnitude`` in force/mass units, angles in degrees. Output: a scalar, the energy in the field.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.fix.formula import write
from asemd.kernels.threads import reduce_sum
from asemd.words import take

ARGUMENTS = {"chute": ("angle",), "spherical": ("phi", "theta"), "vector": ("x", "y", "z")}


class Gravity(Forcing):
    """Gravity.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    magnitude : float or callable
        Acceleration, in force/mass units of the scene.
    kind : str
        ``chute``, ``spherical`` or ``vector``.
    arguments : sequence of float or callable
        Angles in degrees, or the components of a vector of any length.
    disable : bool
        Atoms feel nothing; other fixes take the field from here.

    Raises
    ------
    InputError
        An unknown kind, a wrong number of arguments.
    """

    style = "gravity"
    minimizes = False
    told = 1
    modifies = ("energy",)

    def __init__(self, group: str = "all", magnitude=1.0, kind: str = "vector", arguments=(0.0, 0.0, -1.0), disable: bool = False):
        super().__init__(group, (magnitude, *arguments))
        if kind not in ARGUMENTS:
            raise InputError(f"fix gravity: expected one of {' '.join(ARGUMENTS)}, got {kind!r}{nearest(kind, ARGUMENTS)}")
        if len(arguments) != len(ARGUMENTS[kind]):
            raise InputError(f"fix gravity {kind} needs {' '.join(ARGUMENTS[kind])}, got {len(arguments)} values")
        self.kind, self.disable = kind, disable

    @classmethod
    def from_lammps(cls, group, words, session):
        magnitude, kind = cls.read_values(words, "magnitude", session)[0], (words[1:2] or ["nothing"])[0]
        names = ARGUMENTS.get(kind, ())
        arguments = cls.read_values(take(words[2:], len(names), f"fix gravity {kind}"), " ".join(names), session)
        rest = words[2 + len(names):]
        if kind in ARGUMENTS and rest not in ([], ["disable"]):
            raise InputError(f"fix gravity: unknown keyword {rest[0]!r}, there is disable")
        return cls(group, magnitude, kind, arguments, bool(rest))

    def to_lammps(self) -> list[str]:
        return [write(self.values[0]), self.kind, *(write(v) for v in self.values[1:]), *["disable"] * self.disable]

    def parameters(self, loop) -> np.ndarray:
        super().parameters(loop)
        count = len(self.values)
        self.p = np.concatenate([self.p[:4], np.zeros(3), self.p[4:4 + count]])
        self._set(loop, list(self.values)) if not self.follows else None
        return self.p

    def _set(self, loop, values: list[float]) -> None:
        self.p[4:7] = 0.0 if self.disable else values[0] * self.direction(values[1:], loop.system.dimension)

    def direction(self, values: list[float], dimension: int) -> np.ndarray:
        """(3,) the unit vector of the field."""
        if self.kind == "vector":
            n = np.array(values, float)
            n[dimension:] = 0.0
            length = math.sqrt(n @ n)
            if not length > 0.0:
                raise InputError("fix gravity: the vector must not have length 0")
            return n / length
        phi, theta = (0.0, 180.0 - values[0]) if self.kind == "chute" else values
        phi, theta = math.radians(phi), math.radians(theta)
        if dimension == 2:
            return np.array([math.sin(theta), math.cos(theta), 0.0])
        return np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])

    def follow(self, loop) -> None:
        values = [v(loop) if callable(v) else v for v in self.values]
        if any(np.ndim(v) for v in values):
            raise InputError(f"fix {self.id} (style gravity): variables must be of style equal")
        self._set(loop, values)

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        energy = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                for d in range(3):
                    force = s.mass[i] * p[4 + d]
                    s.f[d, i] += force
                    energy -= force * s.x[d, i]
        energy = reduce_sum(th, energy)
        if th.tid == 0:
            p[3] = energy

    def scalar(self) -> float:
        """Energy in the field, energy units."""
        return float(self.p[3])
