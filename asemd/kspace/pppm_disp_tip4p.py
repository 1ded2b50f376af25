r"""pppm/disp for four-site water (TIP4P): charges of oxygen atoms are on massless sites, the attraction is between atoms.

The water molecules are those of the pair style, see pair_style tip4p/long. Source: LAMMPS manual, kspace_style pppm/disp/tip4p.
"""
from __future__ import annotations

from asemd.kspace.pppm_disp import MeshTerm, PPPMDisp
from asemd.kspace.pppm_tip4p import ChargesOnSites, sites_of


class PPPMDispTIP4P(PPPMDisp):
    """``kspace_style pppm/disp/tip4p accuracy``."""

    style = flag = "pppm/disp/tip4p"
    partner = "lj/long/tip4p/long long long"

    def prepare(self, system, interactions, units, cutoff):
        self.sites, self.site_distance = sites_of(self, interactions)
        super().prepare(system, interactions, units, cutoff)

    def terms(self, engine):
        return [SitesMesh(self, False) if not term.attractive else term for term in super().terms(engine)]


class SitesMesh(ChargesOnSites, MeshTerm):
    """The mesh of charges on sites."""
