r"""Friction on rotation: a torque against the angular velocity of spheres.

.. math:: T_i \leftarrow T_i - \gamma_t\, \omega_i

with :math:`\gamma` scaled by atom type, or by a variable of style atom (``scale v_name``).

Source: LAMMPS manual, fix viscous/sphere. Units: ``gamma`` in torque times time.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.fix.formula import read, write
from asemd.words import number, take, whole


class ViscousSphere(Forcing):
    """Friction on rotation.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    gamma : float
        Friction coefficient, torque times time in units of the scene.
    scale : mapping of int to float, or callable, optional
        Factors by atom type, 1 where none is given; or a function of the loop that returns one per atom.

    Raises
    ------
    InputError
        At the start of a run: atoms without angular velocities.
    """

    style = "viscous/sphere"
    minimizes = True
    by_atom = True

    def __init__(self, group: str = "all", gamma: float = 0.0, scale=None):
        super().__init__(group, (scale,) if callable(scale) else ())
        self.gamma, self.scale = gamma, {} if callable(scale) else dict(scale or {})

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        gamma, scale, words = number(take(words, 1, what)[0], f"{what} gamma"), {}, words[1:]
        variable = None
        while words:
            if words[0] != "scale":
                raise InputError(f"{what}: unknown keyword {words[0]!r}, there is scale type ratio or scale v_name")
            if take(words[1:], 1, f"{what} scale")[0].startswith("v_"):
                variable, words = read(words[1], f"{what} scale", session), words[2:]
                if session.variables.find(variable.name).style not in ("atom", "atomfile"):
                    raise InputError(f"{what} scale: variable {variable.name} must be of style atom")
            else:
                kind, ratio = take(words[1:], 2, f"{what} scale")
                kind = whole(kind, f"{what} scale type")
                if not 1 <= kind <= session.scene.need_system(what).counts["ntypes"]:
                    raise InputError(f"{what} scale: there is no atom type {kind}")
                scale[kind], words = number(ratio, f"{what} scale ratio"), words[3:]
            if variable is not None and scale:
                raise InputError(f"{what} scale: either by type or by a variable, not both")
        return cls(group, gamma, variable or scale)

    def to_lammps(self) -> list[str]:
        by_type = [w for kind, ratio in self.scale.items() for w in ("scale", str(kind), repr(ratio))]
        return [repr(self.gamma), *by_type, *(w for value in self.values for w in ("scale", write(value)))]

    def numbers(self, loop) -> list[float]:
        if "omega" not in loop.system.extra:
            raise InputError("fix viscous/sphere needs atoms with angular velocities: use atom_style sphere, or hybrid with it")
        return [len(self.values), *(self.gamma * self.scale.get(kind, 1.0) for kind in range(len(loop.system.mass)))]

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        own = super().atom_arrays(loop)
        return np.zeros((1, 2)) if own is None else own, loop.system.extra["omega"]

    @hook
    def post_force(th, s, p, a):
        bit, varies, own, omega = np.int32(np.int64(p[0])), p[2] != 0.0, a[0], a[1]
        first = 5 if varies else 4
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                r = s.row[i]
                gamma = p[first + s.type[i]] * (own[r, 1] if varies else 1.0)
                for d in range(3):
                    s.torque[d, i] -= gamma * omega[r, d]
