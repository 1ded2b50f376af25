r"""pppm/disp for charges of which each stands in a medium of its own: charges as in pppm/dielectric, the attraction as in pppm/disp."""
from __future__ import annotations

from asemd.kspace.dielectric import Dielectric, DielectricTerm
from asemd.kspace.pppm_disp import MeshTerm, PPPMDisp


class PPPMDispDielectric(Dielectric, PPPMDisp):
    """``kspace_style pppm/disp/dielectric accuracy``. The mesh is that of the charges without their constants, as in LAMMPS."""

    style = flag = "pppm/disp/dielectric"
    partner = "lj/long/coul/long/dielectric long long"

    def terms(self, engine):
        return [(MeshTerm if t.attractive else DielectricMeshTerm)(self, t.attractive) for t in super().terms(engine)]


class DielectricMeshTerm(DielectricTerm, MeshTerm):
    """The mesh of the charges, for three sets of them."""
