r"""Keep the centre of mass of a group where it is, by moving atoms at the beginning of each step; velocities stay.

.. math:: r_i \leftarrow r_i + (c_0 - c)

The place: ``INIT`` where the centre was when the fix was defined, NULL (None): that direction is left alone. It stands after the fixes
that move the atoms.

Source: LAMMPS manual, fix recenter. Arguments: x y z; shift group, the atoms that are moved; units box, lattice or fraction. Output: a
scalar, the length of the last shift; a vector of 3, the shift.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.forcing import Forcing, centre_of_mass, unwrapped
from asemd.kernels.threads import barrier
from asemd.words import choice, number, take

UNITS = ("box", "lattice", "fraction")


class Recenter(Forcing):
    """Hold the centre of mass.

    Parameters
    ----------
    group : str
        The atoms whose centre is held.
    place : sequence of 3 of float or None or ``INIT``
        Where, distance units of the scene.
    shift : str, optional
        Name of the group that is moved; the same by default.
    """

    style = "recenter"
    minimizes = False
    levels = "every"
    told, size, first = 4, 3, 4

    def __init__(self, group: str = "all", place=("INIT", "INIT", "INIT"), shift: str | None = None):
        super().__init__(group)
        if len(place) != 3:
            raise InputError(f"fix recenter: a place has 3 coordinates, got {len(place)}")
        self.place, self.shift = tuple(place), group if shift is None else shift
        self.fraction = False
        self.centre: np.ndarray | None = None
        self.words: list[str] = []

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix recenter"
        place = take(words, 3, f"{what} x y z")
        options, rest = {"shift": None, "units": "lattice"}, words[3:]
        while rest:
            if rest[0] not in options:
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], options)}")
            options[rest[0]], rest = take(rest[1:], 1, f"{what} {rest[0]}")[0], rest[2:]
        choice(options["units"], UNITS, f"{what} units")
        if options["shift"] is not None:
            session.scene.groups.mask(options["shift"], f"{what} shift")
        scene = session.scene
        spacings = scene.lattice.spacings if options["units"] == "lattice" and scene.lattice is not None else np.ones(3)
        special = {"INIT": "INIT", "NULL": None}
        fix = cls(group, [special[w] if w in special else number(w, f"{what} {'xyz'[d]}") * float(spacings[d])
                          for d, w in enumerate(place)], options["shift"])
        fix.fraction, fix.words = options["units"] == "fraction", list(words)
        fix.centre = fix.present(scene.system, scene.groups.mask(group))
        return fix

    def to_lammps(self) -> list[str]:
        place = ["NULL" if v is None else v if v == "INIT" else repr(float(v)) for v in self.place]
        return list(self.words) or [*place, "shift", self.shift, "units", "box"]

    @staticmethod
    def present(system, mask: np.ndarray) -> np.ndarray:
        """(3,) the centre of mass of the atoms of `mask`."""
        m = system.atom_masses()[mask]
        return m @ system.box.unwrap(system.x, system.image)[mask] / max(m.sum(), 1e-300)

    def numbers(self, loop) -> list[float]:
        if self.centre is None:
            self.centre = self.present(loop.system, loop.groups[self.group])
        box, target = loop.system.box, []
        for d, value in enumerate(self.place):
            if value == "INIT":
                target.append(float(self.centre[d]))
            else:
                value = value or 0.0
                target.append(float(box.origin[d] + value * box.cell[d, d]) if self.fraction else value)
        return [*target, *(float(v is not None) for v in self.place), loop.group_bit(self.shift)]

    @hook(uses=[unwrapped, centre_of_mass])
    def initial_integrate(th, s, p, a):
        mass, x, y, z = centre_of_mass(th, s, np.int32(np.int64(p[0])))
        dx, dy, dz = p[10] * (p[7] - x), p[11] * (p[8] - y), p[12] * (p[9] - z)
        moved = np.int32(np.int64(p[13]))
        for i in range(th.lo, th.hi):
            if s.mask[i] & moved != 0:
                s.x[0, i] += dx
                s.x[1, i] += dy
                s.x[2, i] += dz
        barrier(th)
        if th.tid == 0:
            p[3], p[4], p[5], p[6] = math.sqrt(dx * dx + dy * dy + dz * dz), dx, dy, dz

    def scalar(self) -> float:
        """Length of the last shift, distance units."""
        return float(self.p[3])
