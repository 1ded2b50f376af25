"""Many small rigid bodies, molecules for example: `asemd.fix.rigid.Rigid` without an array of all bodies.

LAMMPS spreads these bodies over its processes; here both styles do the same. Source: LAMMPS manual, fix rigid/small.
"""
from __future__ import annotations

from asemd.fix.rigid import Rigid
from asemd.fix.rigid_added import AddedBodies


class RigidSmall(AddedBodies, Rigid):
    """Rigid bodies; see `asemd.fix.rigid.Rigid` for the arguments."""

    style = "rigid/small"
