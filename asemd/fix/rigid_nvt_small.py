"""Many small rigid bodies: `asemd.fix.rigid_nvt.RigidNVT` without an array of all bodies.

Source: LAMMPS manual, fix rigid/nvt/small.
"""
from __future__ import annotations

from asemd.fix.rigid_added import AddedBodies
from asemd.fix.rigid_nvt import RigidNVT


class RigidNVTSmall(AddedBodies, RigidNVT):
    """Rigid bodies; see `asemd.fix.rigid_nvt.RigidNVT` for the arguments."""

    style = "rigid/nvt/small"
