"""Many small rigid bodies: `asemd.fix.rigid_nph.RigidNPH` without an array of all bodies.

Source: LAMMPS manual, fix rigid/nph/small.
"""
from __future__ import annotations

from asemd.fix.rigid_added import AddedBodies
from asemd.fix.rigid_nph import RigidNPH


class RigidNPHSmall(AddedBodies, RigidNPH):
    """Rigid bodies; see `asemd.fix.rigid_nvt.RigidNVT` for the arguments."""

    style = "rigid/nph/small"
