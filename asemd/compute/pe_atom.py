r"""Potential energy of each atom of a group.

The energy of a bond, angle ... pair is shared equally by its atoms, so the sum over all atoms is the potential energy without the tail
correction. Keywords pick terms: pair bond angle dihedral improper kspace fix.

Source: LAMMPS manual, compute pe/atom. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._energy_terms import EnergyTerms


class PEAtom(EnergyTerms):
    """Potential energy per atom.

    Parameters
    ----------
    group : str
        The atoms it reports; partners outside the group count.
    terms : sequence of str, optional
        Some of pair, bond, angle, dihedral, improper, kspace, fix; None: all.

    Raises
    ------
    InputError
        An unknown term.
    """

    style = "pe/atom"
    needs = frozenset({"energy", "energies"})

    def per_atom(self, state) -> np.ndarray:
        """(n,) energies; zero outside the group."""
        if self.terms:
            of = state.result.energies_of
            energies = sum((of[term] for term in self.terms if term in of), np.zeros(state.system.n))
        else:
            energies = state.result.energies
        if not self.terms or "fix" in self.terms:
            for fix in state.fixes:
                if fix.thermo_energy and hasattr(fix, "energies"):
                    energies = energies + fix.energies(state)
        return np.where(state.mask(self.group), energies, 0.0)
