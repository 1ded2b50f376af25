"""Multilevel summation where most atoms have no charge: msm that passes over charges of at most a smallest one.

Error estimates and the energy that charges have by themselves count every charge, as in LAMMPS.
"""
from __future__ import annotations

from asemd.kspace.msm import MSM
from asemd.kspace.pppm_cg import FewCharges


class MSMCG(FewCharges, MSM):
    """``kspace_style msm/cg accuracy [smallest charge]``; the latter is 1e-5 without that word."""

    style = "msm/cg"
