r"""Translational kinetic energy of the rigid bodies of a fix.

.. math:: E = \frac12 \sum_b M_b v_b^2

with the velocities of the centres of mass. Source: LAMMPS manual, compute ke/rigid. Units: energy.
"""
from __future__ import annotations

from asemd.compute.erotate_rigid import ErotateRigid


class KERigid(ErotateRigid):
    """Translational energy of rigid bodies; see `asemd.compute.erotate_rigid.ErotateRigid` for the arguments."""

    style = "ke/rigid"
    part = 0
