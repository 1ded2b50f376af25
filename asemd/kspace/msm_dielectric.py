r"""msm for charges of which each stands in a medium of its own, with the dielectric constant that the atom has.

Forces, energy and virial are those of pppm/dielectric, where LAMMPS's grid takes the charges without their constants.
"""
from __future__ import annotations

from asemd.kspace.dielectric import Dielectric, DielectricTerm
from asemd.kspace.msm import MSM, MSMTerm


class MSMDielectric(Dielectric, MSM):
    """``kspace_style msm/dielectric accuracy``."""

    style = flag = "msm/dielectric"
    partner = "lj/cut/coul/msm/dielectric"

    def terms(self, engine):
        return [MSMDielectricTerm(self)]


class MSMDielectricTerm(DielectricTerm, MSMTerm):
    """The grids, for three sets of charges."""
