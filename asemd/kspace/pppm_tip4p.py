r"""pppm for four-site water (TIP4P): charges of oxygen atoms are on massless sites, whose forces their three atoms share.

The water molecules are those of the pair style, see pair_style tip4p/long. LAMMPS leaves the correction of ``kspace_modify slab`` out of
the energy of this style; here it is in, and forces are its gradient, unless ``compat="lammps"``. Source: LAMMPS manual, kspace_style
pppm/tip4p.
"""
from __future__ import annotations

import math

from asemd.kspace.pppm import PPPM, PPPMTerm
from asemd.site_terms import OnSites


def sites_of(solver, interactions):
    """The `asemd.charge_sites.ChargeSites` of the pair style that leaves its charges to the solver, and their distance from oxygen."""
    use = next(use for use in interactions.uses["pair"] if solver.flag in use.style.works_with(use.settings))
    return use.style.sites(use.settings, interactions), use.settings["qdist"]


class PPPMTIP4P(PPPM):
    """``kspace_style pppm/tip4p accuracy``."""

    style = flag = "pppm/tip4p"
    groups = False

    def prepare(self, system, interactions, units, cutoff):
        self.sites, self.site_distance = sites_of(self, interactions)
        self.like_lammps = interactions.compat == "lammps"
        super().prepare(system, interactions, units, cutoff)

    def terms(self, engine):
        return [TIP4PTerm(self)]


class ChargesOnSites(OnSites):
    """A mesh of charges on sites; before the class of the term that it is otherwise."""

    of_places = False

    def __init__(self, solver, *arguments):
        super().__init__(solver, *arguments)
        self.sites = solver.sites

    def hand_over(self, engine, energy, virial):
        """As others, but the energy of a charge by itself stays with its oxygen atom."""
        if not len(energy):
            super().hand_over(engine, energy, virial)
            return
        s, oxygen, volume = self.solver, self._atoms[:, 0], self.held[3, 0]
        q = engine.system.q[oxygen]
        own = self.constants[1] * (s.g_ewald * q * q / math.sqrt(math.pi) + 0.5 * math.pi * q * s.qsum / (s.g_ewald**2 * volume))
        energy[oxygen] += own
        super().hand_over(engine, energy, virial)
        energy[oxygen] -= own


class TIP4PTerm(ChargesOnSites, PPPMTerm):
    """The mesh of charges on sites."""

    def __init__(self, solver):
        super().__init__(solver)
        if solver.like_lammps and self.constants[5] == 1.0:
            self.constants[5] = 4.0
