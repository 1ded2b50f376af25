r"""A spring between each atom and the place where it was when this fix was defined.

.. math:: E = \tfrac12 \sum_i K (r_i - r_{i0})^2

Directions may be left out (``xyz``, ``xy``, ``x`` ...). Positions are unwrapped.

Source: LAMMPS manual, fix spring/self. Units: ``K`` in force/distance units. Output: a scalar, the energy.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.fix.formula import Value, write
from asemd.kernels.threads import reduce_sum
from asemd.words import choice

DIRECTIONS = ("xyz", "xy", "yz", "xz", "x", "y", "z")


class SpringSelf(Forcing):
    """Tether atoms to their places.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    k : float or callable
        Spring constant, force/distance units of the scene; a function of the loop returns one number or one per atom.
    directions : str
        Some of x, y and z.

    Raises
    ------
    InputError
        A constant that is not positive.
    """

    style = "spring/self"
    restarts = ("peratom",)
    told = 1
    modifies = ("energy",)
    conservative = True
    by_atom = True

    def __init__(self, group: str = "all", k: Value = 1.0, directions: str = "xyz"):
        super().__init__(group, (k,))
        if not callable(k) and k <= 0.0:
            raise InputError(f"fix spring/self: K must be positive, got {k:g}")
        self.directions = choice(directions, DIRECTIONS, "fix spring/self")
        self.places: np.ndarray | None = None       # (n, 3) unwrapped

    @classmethod
    def from_lammps(cls, group, words, session):
        k = cls.read_values(words, "K", session)[0]
        if len(words) > 2:
            raise InputError(f"fix spring/self: too many words: {' '.join(words[2:])}")
        fix = cls(group, k, *words[1:])
        system = session.scene.system
        fix.places = system.box.unwrap(system.x, system.image)
        return fix

    def to_lammps(self) -> list[str]:
        return [write(self.values[0]), self.directions]

    def numbers(self, loop) -> list[float]:
        return [float(d in self.directions) for d in "xyz"]

    def atom_arrays(self, loop) -> np.ndarray:
        system, k = loop.system, self.values[0]
        if self.places is None or len(self.places) != system.n:
            self.places = system.box.unwrap(system.x, system.image)
        self.a = np.column_stack([np.ones(system.n), np.full(system.n, 0.0 if callable(k) else k), self.places])
        return self.a

    @hook
    def post_force(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        v = s.box.vectors
        energy = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                k = a[row, 1]
                for d in range(3):
                    x = s.x[d, i] + s.image[row, 0] * v[0, d] + s.image[row, 1] * v[1, d] + s.image[row, 2] * v[2, d]
                    away = p[5 + d] * (x - a[row, 2 + d])
                    s.f[d, i] -= k * away
                    energy += 0.5 * k * away * away
        energy = reduce_sum(th, energy)
        if th.tid == 0:
            p[3] = energy

    def scalar(self) -> float:
        """Energy of the springs, energy units."""
        return float(self.p[3])

    def state(self) -> dict:
        """The places of the springs."""
        return {} if self.places is None else {"places": self.places}

    def restore(self, state: dict) -> None:
        self.places = np.array(state["places"]) if "places" in state else None
