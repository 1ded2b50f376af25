"""What the Nose-Hoover integrators of spheres have beside those of points: radii, dipoles that turn, a temperature with rotation."""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp
from asemd.compute.temp_sphere import TempSphere
from asemd.errors import InputError, nearest
from asemd.fix.spheres import UPDATES, check_radii, check_spheres, kick_spins, sphere_arrays, turn_along


def countable(temp) -> bool:
    """Whether compiled hooks can measure a temperature: that of all velocities of a group, with or without rotation."""
    return type(temp) is Temp or (type(temp) is TempSphere and not temp.bias)


class SphereBath:
    """Goes before `asemd.fix.nvt.NVT`, `asemd.fix.npt.NPT` or `asemd.fix.nph.NPH` among the base classes of a fix."""

    turns = True

    def set_turning(self, dipole: str, disc: bool) -> None:
        """Whether dipoles turn along, and which moment of inertia it is.

        Raises
        ------
        InputError
            An unknown way of turning dipoles.
        """
        if dipole and dipole not in UPDATES:
            raise InputError(f"fix {self.style}: unknown update {dipole!r}{nearest(dipole, UPDATES)}")
        self.dipole, self.disc = dipole, disc

    @classmethod
    def from_lammps(cls, group, words, session):
        fix = super().from_lammps(group, words, session)
        check_spheres(fix, session.scene.need_system(f"fix {cls.style}"))
        return fix

    def to_lammps(self) -> list[str]:
        return super().to_lammps() + (["update", self.dipole] if self.dipole else []) + ["disc"] * self.disc

    @property
    def all_plain(self) -> bool:
        press = getattr(self, "press", None)
        return countable(self.temp) and (press is None or countable(press.temperature or self.temp))

    def parameters(self, loop) -> np.ndarray:
        check_radii(self, loop)
        return super().parameters(loop)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Of a barostat its own numbers first, then those of the spheres."""
        self.turning = sphere_arrays(self, loop)
        return (super().atom_arrays(loop) or ()) + self.turning

    def kick_turning(self, loop, bit: int) -> None:
        """Half a step of the torques, not compiled."""
        omega, radius, _, o = self.turning
        kick_spins(loop._thread(), loop.state, bit, 1.0, omega, radius, o)

    def turn(self, loop, bit: int) -> None:
        """A step of the dipoles, not compiled."""
        omega, radius, mu, o = self.turning
        turn_along(loop._thread(), loop.state, bit, omega, radius, mu, o)
