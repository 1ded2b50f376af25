"""Many small rigid bodies at constant energy: `asemd.fix.rigid_nve.RigidNVE` without an array of all bodies.

Source: LAMMPS manual, fix rigid/nve/small.
"""
from __future__ import annotations

from asemd.fix.rigid_added import AddedBodies
from asemd.fix.rigid_nve import RigidNVE


class RigidNVESmall(AddedBodies, RigidNVE):
    """Rigid bodies; see `asemd.fix.rigid.Rigid` for the arguments."""

    style = "rigid/nve/small"

    def scalar(self) -> float:
        """As in LAMMPS the energy of rotation and twice that of translation, energy units."""
        translation, rotation = (e.sum() for e in self.bodies_energies())
        return float(2.0 * translation + rotation)
