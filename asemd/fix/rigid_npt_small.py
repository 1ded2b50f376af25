"""Many small rigid bodies: `asemd.fix.rigid_npt.RigidNPT` without an array of all bodies.

Source: LAMMPS manual, fix rigid/npt/small.
"""
from __future__ import annotations

from asemd.fix.rigid_added import AddedBodies
from asemd.fix.rigid_npt import RigidNPT


class RigidNPTSmall(AddedBodies, RigidNPT):
    """Rigid bodies; see `asemd.fix.rigid_nvt.RigidNVT` for the arguments."""

    style = "rigid/npt/small"
