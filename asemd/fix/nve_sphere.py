r"""Constant energy for spheres that turn: velocity Verlet for positions and angular velocities.

.. math:: \omega \leftarrow \omega + \tfrac{\Delta t}{2} \frac{T}{I}, \qquad I = \tfrac25 m R^2 \quad (\text{``disc''}: \tfrac12 m R^2)

With ``update dipole`` the dipole turns with its sphere: by one step of :math:`\dot\mu = \omega \times \mu` at constant length, or with
``dipole/dlm`` by the symplectic product of rotations of Dullweber, Leimkuhler and McLachlan, which also turns :math:`\omega` and keeps the
energy better.

Source: A. Dullweber, B. Leimkuhler, R. McLachlan, J. Chem. Phys. 107, 5840 (1997); LAMMPS manual, fix nve/sphere.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.fix.spheres import TURNS, UPDATES, check_radii, check_spheres, kick_spins, sphere_arrays, turn_along
from asemd.words import take


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
    levels = "every"

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
            elif words[0] == "update":
                dipole = take(words[1:], 1, f"fix {cls.style} update")[0]
                words = words[2:]
            else:
                raise InputError(f"fix {cls.style}: unknown keyword {words[0]!r}{nearest(words[0], ('update', 'disc'))}")
        fix = cls(group, dipole, disc)
        check_spheres(fix, session.scene.need_system(f"fix {cls.style}"))
        return fix

    def to_lammps(self) -> list[str]:
        return (["update", self.dipole] if self.dipole else []) + ["disc"] * self.disc

    def parameters(self, loop) -> np.ndarray:
        check_radii(self, loop)
        return super().parameters(loop)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        return sphere_arrays(self, loop)

    @hook(uses=TURNS)
    def initial_integrate(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        omega, radius, mu, o = a
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            x, v, f = s.x[d, mine], s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]
                    x[i] += th.dt * v[i]
        kick_spins(th, s, bit, 1.0, omega, radius, o)
        turn_along(th, s, bit, omega, radius, mu, o)

    @hook(uses=TURNS)
    def final_integrate(th, s, p, a):
        bit, half, mine = np.int32(np.int64(p[0])), 0.5 * th.dt, slice(th.lo, th.hi)
        omega, radius, mu, o = a
        mask, inverse_mass = s.mask[mine], s.inverse_mass[mine]
        for d in range(3):
            v, f = s.v[d, mine], s.f[d, mine]
            for i in range(v.size):
                if mask[i] & bit != 0:
                    v[i] += half * inverse_mass[i] * f[i]
        kick_spins(th, s, bit, 1.0, omega, radius, o)
