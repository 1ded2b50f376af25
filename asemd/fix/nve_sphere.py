r"""Constant energy for spheres that turn: velocity Verlet for positions and angular velocities.

.. math:: \omega \leftarrow \omega + \tfrac{\Delta t}{2} \frac{T}{I}, \qquad I = \tfrac25 m R^2 \quad (\text{``disc''}: \tfrac12 m R^2)

With ``update dipole`` the dipole turns with its sphere: by one step of :math:`\dot\mu = \omega \times \mu` at constant length, or with
``dipole/dlm`` by the symplectic product of rotations of Dullweber, Leimkuhler and McLachlan, which also turns :math:`\omega` and keeps the
energy better.

Source: A. Dullweber, B. Leimkuhler, R. McLachlan, J. Chem. Phys. 107, 5840 (1997); LAMMPS manual, fix nve/sphere.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.words import take

NONE, PLAIN, DLM = 0.0, 1.0, 2.0
UPDATES = {"dipole": PLAIN, "dipole/dlm": DLM}


def turn(q, w, axis, angle):
    """Rotate the angular velocity `w` and the frame `q`, rows in the body, about one of the body's axes (small-angle form of the angle)."""
    square = 0.25 * angle * angle
    c, s = (1.0 - square) / (1.0 + square), angle / (1.0 + square)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    wj, wk = w[j], w[k]
    w[j], w[k] = c * wj - s * wk, s * wj + c * wk
    for d in range(3):
        qj, qk = q[j, d], q[k, d]
        q[j, d], q[k, d] = c * qj + s * qk, -s * qj + c * qk


class NVESphere(Fix):
    """Time integration of spheres.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a radius.
    dipole : str
        ``dipole`` or ``dipole/dlm``: dipoles turn along; empty: they stay.
    disc : bool
        Discs in two dimensions: another moment of inertia.

    Raises
    ------
    InputError
        An unknown way of turning dipoles.
    """

    style = "nve/sphere"
    integrates = True

    def __init__(self, group: str = "all", dipole: str = "", disc: bool = False):
        super().__init__(group)
        if dipole and dipole not in UPDATES:
            raise InputError(f"fix {self.style}: unknown update {dipole!r}{nearest(dipole, UPDATES)}")
        self.dipole, self.disc = dipole, disc

    @classmethod
    def from_lammps(cls, group, words, session):
        dipole, disc = "", False
        while words:
            if words[0] == "disc":
                disc, words = True, words[1:]
                if session.scene.dimension != 2:
                    raise InputError(f"fix {cls.style} disc is for two dimensions")
            elif words[0] == "update":
                dipole = take(words[1:], 1, f"fix {cls.style} update")[0]
                words = words[2:]
            else:
                raise InputError(f"fix {cls.style}: unknown keyword {words[0]!r}{nearest(words[0], ('update', 'disc'))}")
        fix = cls(group, dipole, disc)
        fix.check_atoms(session.scene.system)
        return fix

    def to_lammps(self) -> list[str]:
        return (["update", self.dipole] if self.dipole else []) + ["disc"] * self.disc

    def check_atoms(self, system) -> None:
        """Whether atoms have what it needs.

        Raises
        ------
        InputError
        """
        if "radius" not in system.extra:
            raise InputError(f"fix {self.style} needs atoms with a radius: use atom_style sphere, or hybrid with it")
        if self.dipole and "mu" not in system.extra:
            raise InputError(f"fix {self.style} update {self.dipole} needs atoms with dipoles: use atom_style hybrid sphere dipole")

    def parameters(self, loop) -> np.ndarray:
        system = loop.system
        self.check_atoms(system)
        points = loop.groups[self.group] & ~(system.extra["radius"] > 0.0)
        if points.any():
            raise InputError(f"fix {self.style}: atom {system.id[points].min()} is a point, all atoms need a radius; fix nve moves points")
        if any(t.category == "angle" and hasattr(t, "torque") for t in loop.engine.terms):
            raise InputError(f"fix {self.style} cannot act on the torques of angle_style dipole yet: leave one of the two out")
        return np.array([loop.group_bit(self.group), UPDATES.get(self.dipole, NONE), 0.5 if self.disc else 0.4, loop.units.ftm2v])

    def setup(self, loop) -> None:
        """
        Raises
        ------
        InputError
            Another fix turns the dipoles.
        """
        if loop.engine.torques:
            raise InputError(f"fix {self.style} cannot act on the torques of fix efield on dipoles yet: leave one of the two out")

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Angular velocities, torques, masses times radius squared, dipoles."""
        system, extra = loop.system, loop.system.extra
        mu = extra["mu"] if "mu" in extra else np.zeros((1, 3))
        return extra["omega"], extra["torque"], system.atom_masses() * extra["radius"] ** 2, mu

    @hook(uses=[turn])
    def initial_integrate(th, s, p, a):
        bit, half, update = np.int32(np.int64(p[0])), 0.5 * th.dt, p[1]
        omega, torque, square, mu = a
        q, w = np.zeros((3, 3)), np.zeros(3)
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit == 0:
                continue
            r = s.row[i]
            for d in range(3):
                s.v[d, i] += half * s.inverse_mass[i] * s.f[d, i]
                s.x[d, i] += th.dt * s.v[d, i]
                omega[r, d] += half * p[3] / (p[2] * square[r]) * torque[r, d]
                torque[r, d] = 0.0      # that of this step is added by whoever turns the spheres
            if update == 0.0:
                continue
            length = math.sqrt(mu[r, 0] ** 2 + mu[r, 1] ** 2 + mu[r, 2] ** 2)
            if length == 0.0:
                continue
            if update == 1.0:
                x = mu[r, 0] + th.dt * (omega[r, 1] * mu[r, 2] - omega[r, 2] * mu[r, 1])
                y = mu[r, 1] + th.dt * (omega[r, 2] * mu[r, 0] - omega[r, 0] * mu[r, 2])
                z = mu[r, 2] + th.dt * (omega[r, 0] * mu[r, 1] - omega[r, 1] * mu[r, 0])
                scale = length / math.sqrt(x * x + y * y + z * z)
                mu[r, 0], mu[r, 1], mu[r, 2] = x * scale, y * scale, z * scale
                continue
            # rows of q are the axes of a body whose z axis is the dipole
            a0, a1, a2 = mu[r, 0] / length, mu[r, 1] / length, mu[r, 2] / length
            across = a0 * a0 + a1 * a1
            if across != 0.0:
                c = (1.0 - a2) / across
                q[0, 0], q[0, 1], q[0, 2] = 1.0 - c * a0 * a0, -c * a0 * a1, -a0
                q[1, 0], q[1, 1], q[1, 2] = -c * a0 * a1, 1.0 - c * a1 * a1, -a1
                q[2, 0], q[2, 1], q[2, 2] = a0, a1, 1.0 - c * across
            else:
                q[:] = 0.0
                q[0, 0], q[1, 1], q[2, 2] = 1.0 / a2, 1.0, a2
            for d in range(3):
                w[d] = q[d, 0] * omega[r, 0] + q[d, 1] * omega[r, 1] + q[d, 2] * omega[r, 2]
            turn(q, w, 0, half * w[0])
            turn(q, w, 1, half * w[1])
            turn(q, w, 2, th.dt * w[2])
            turn(q, w, 1, half * w[1])
            turn(q, w, 0, half * w[0])
            for d in range(3):
                omega[r, d] = q[0, d] * w[0] + q[1, d] * w[1] + q[2, d] * w[2]
                mu[r, d] = length * q[2, d]

    @hook
    def final_integrate(th, s, p, a):
        bit, half = np.int32(np.int64(p[0])), 0.5 * th.dt
        omega, torque, square, mu = a
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                r = s.row[i]
                for d in range(3):
                    s.v[d, i] += half * s.inverse_mass[i] * s.f[d, i]
                    omega[r, d] += half * p[3] / (p[2] * square[r]) * torque[r, d]


