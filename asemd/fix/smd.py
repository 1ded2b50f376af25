r"""Steered dynamics: a group is pulled by a moving spring or a constant force.

With the centre of mass c of the group, the unit vector n from it to the point (``tether``) or to the centre of the second group
(``couple``; or along the vector that is given), and the distance :math:`R_t = R_{start} + v t`: the spring (``cvel``) pulls with

.. math:: F = -K (R - R_0 - R_t)\, \hat R \;\; \text{(tether)},
          \qquad F = K (|D| - R_0)\, \hat D, \;\; D = c_2 - c_1 - R_t\, n \;\; \text{(couple)}

and ``cfor`` with a constant force along the line. Each atom gets the share :math:`m_i / M`. Positions are unwrapped.

Source: S. Izrailev et al., Computational Molecular Dynamics (Springer 1998); S. Park, K. Schulten, J. Chem. Phys. 120, 5946 (2004); LAMMPS
manual, fix smd. Units: ``K`` in force/distance units. Output: a vector of 7: the force, that along the pull, the distance of the spring's
end, the distance of the two points, the work so far (the potential of mean force).
``fix_modify ID virial yes`` counts the force of ``tether`` in the pressure.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing, centre_of_mass, tally, unwrapped
from asemd.kernels.threads import barrier
from asemd.words import choice, exactly, number, take


class SMD(Forcing):
    """Steered molecular dynamics.

    Parameters
    ----------
    group : str
        The atoms that are pulled.
    k, velocity : float
        Spring constant and speed of its end, force/distance and distance/time units of the scene.
    force : float, optional
        Constant force instead of the spring, force units.
    point : sequence of 3 of float or None or ``auto``
        The point, or the direction from the group to the second one; None: that direction does not count; ``auto``: the direction follows
        the groups.
    length : float
        R0, distance units.
    couple : str
        Name of the second group; empty: the group is pulled to or from the point.

    Raises
    ------
    InputError
        A negative length, the same group twice, ``auto`` without a second group.
    """

    style = "smd"
    minimizes = False
    told, size = 7, 7
    modifies = ("virial",)

    def __init__(self, group: str = "all", k: float = 1.0, velocity: float = 0.0, force: float | None = None, point=(0.0, 0.0, 0.0),
                 length: float = 0.0, couple: str = ""):
        super().__init__(group, [0.0 if v == "auto" else v for v in point])
        self.auto = tuple(v == "auto" for v in point)
        if len(self.values) != 3 or (any(self.auto) and not couple):
            raise InputError("fix smd: a point has 3 coordinates; auto is for couple")
        if length < 0.0:
            raise InputError(f"fix smd: R0 must not be negative, got {length:g}")
        if couple == group:
            raise InputError("fix smd: Two groups cannot be the same in fix smd couple")
        self.k, self.velocity, self.force, self.length, self.couple = k, velocity, force, length, couple
        self.work = 0.0

    @classmethod
    def from_lammps(cls, group, words, session):
        mode = choice(take(words, 1, "fix smd")[0], ("cvel", "cfor"), "fix smd")
        count = 2 if mode == "cvel" else 1
        given = [number(w, f"fix smd {mode}") for w in take(words[1:], count, f"fix smd {mode}")]
        words = words[1 + count:]
        kind = choice(take(words, 1, f"fix smd {mode}")[0], ("tether", "couple"), "fix smd")
        what, other = f"fix smd {kind}", ""
        rest = exactly(words[1:], 4 + (kind == "couple"), what)
        if kind == "couple":
            other, rest = rest[0], rest[1:]
            session.scene.groups.mask(other, what)
        words_of = {"NULL": None, "auto": "auto"} if other else {"NULL": None}
        point = [words_of[w] if w in words_of else number(w, f"{what} point") for w in rest[:3]]
        options = {"k": given[0], "velocity": given[1]} if mode == "cvel" else {"force": given[0]}
        return cls(group, point=point, length=number(rest[3], f"{what} R0"), couple=other, **options)

    def to_lammps(self) -> list[str]:
        mode = ["cvel", repr(self.k), repr(self.velocity)] if self.force is None else ["cfor", repr(self.force)]
        point = ["auto" if auto else w for auto, w in zip(self.auto, self.value_words())]
        return [*mode, *(["couple", self.couple] if self.couple else ["tether"]), *point, repr(self.length)]

    def numbers(self, loop) -> list[float]:
        other = loop.group_bit(self.couple) if self.couple else 0.0
        return [*(float(v is not None) for v in self.values), *map(float, self.auto), other, self.force is not None, self.k, self.velocity,
                self.force or 0.0, self.length, *self._begin(loop), self.work]

    def _begin(self, loop) -> list[float]:
        system = loop.system
        m, x = system.atom_masses(), system.box.unwrap(system.x, system.image)

        def centre(name):
            mask = loop.groups[name]
            return m[mask] @ x[mask] / max(m[mask].sum(), 1e-300)
        point = np.array([0.0 if v is None else v for v in self.values])
        d = np.where(self.auto, centre(self.couple) - centre(self.group), point) if self.couple else point - centre(self.group)
        d = np.where([v is not None for v in self.values], d, 0.0)
        r = float(np.sqrt(d @ d))
        return [*(d / r if r > 1e-3 else d * 0.0), r]

    @hook(uses=[unwrapped, centre_of_mass, tally])
    def post_force(th, s, p, a):
        bit, other = np.int32(np.int64(p[0])), np.int32(np.int64(p[19]))
        mass, x, y, z = centre_of_mass(th, s, bit)
        mass2 = 0.0
        nx, ny, nz, far = p[25], p[26], p[27], p[28]
        fx, fy, fz = 0.0, 0.0, 0.0
        if other == 0:
            dx, dy, dz = x - p[10], y - p[11], z - p[12]
            now = math.sqrt(dx * dx + dy * dy + dz * dz)
            dx, dy, dz = p[13] * dx, p[14] * dy, p[15] * dz
            r = math.sqrt(dx * dx + dy * dy + dz * dz)
            if p[20] == 0.0:
                pull = p[21] * (r - p[24] - far)
            else:
                pull = p[23]
                far = r
            if r > 1e-3:
                fx, fy, fz = pull * dx / r, pull * dy / r, pull * dz / r
        else:
            mass2, x2, y2, z2 = centre_of_mass(th, s, other)
            x, y, z = x2 - x, y2 - y, z2 - z
            dx = p[13] * (x if p[16] != 0.0 else nx * far)
            dy = p[14] * (y if p[17] != 0.0 else ny * far)
            dz = p[15] * (z if p[18] != 0.0 else nz * far)
            r = math.sqrt(dx * dx + dy * dy + dz * dz)
            if r > 1e-3:
                nx, ny, nz = dx / r, dy / r, dz / r
            if p[20] == 0.0:
                now = math.sqrt(x * x + y * y + z * z)
                dx, dy, dz = p[13] * (x - nx * far), p[14] * (y - ny * far), p[15] * (z - nz * far)
                r = math.sqrt(dx * dx + dy * dy + dz * dz)
                pull = p[21] * (r - p[24]) / r if r > 1e-3 else 0.0
                fx, fy, fz = pull * dx, pull * dy, pull * dz
            else:
                now = math.sqrt(x * x + y * y + z * z)
                far = r
                fx, fy, fz = p[23] * nx, p[23] * ny, p[23] * nz
        barrier(th)
        if th.tid == 0:
            if p[20] == 0.0:
                p[29] += (fx * nx + fy * ny + fz * nz) * (p[22] if other == 0 else abs(p[22])) * th.dt       # LAMMPS's signs
                far += p[22] * th.dt
            p[25], p[26], p[27], p[28] = nx, ny, nz, far
        if other == 0:
            fx, fy, fz = -fx, -fy, -fz
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
                if p[1] != 0.0 and other == 0:      # nothing of two groups
                    tally(th, s, i, fx * share, fy * share, fz * share)
        if th.tid == 0:
            p[3], p[4], p[5] = fx, fy, fz
            p[6] = p[23] if p[20] != 0.0 else fx * nx + fy * ny + fz * nz
            p[7], p[8], p[9] = far, now, p[29]

    def finish(self, loop) -> None:
        self.work = float(self.p[29])

    def state(self) -> dict:
        """The work so far; direction and distance are those of the groups when a run begins."""
        return {"work": self.work}

    def restore(self, state: dict) -> None:
        self.work = state["work"]
