r"""Potential energy of the whole system, or of some of its terms.

Without keywords it is the sum of all terms, with the long-range (tail) correction of the pair style and with the energy of fixes that were
told to count (``fix_modify ID energy yes``). Keywords pick terms: pair bond angle dihedral improper kspace extra fix.

Source: LAMMPS manual, compute pe. Units: energy, for the whole system (not per atom).
"""
from __future__ import annotations

from asemd.compute._energy_terms import TERMS, EnergyTerms
from asemd.errors import InputError


class PE(EnergyTerms):
    """Potential energy.

    Parameters
    ----------
    group : str
        Must be ``all``.
    terms : sequence of str, optional
        Some of pair, bond, angle, dihedral, improper, kspace, fix; None: all.

    Raises
    ------
    InputError
        Another group, or an unknown term.
    """

    style = "pe"
    needs = frozenset({"energy"})

    def __init__(self, group: str = "all", terms=None):
        if group != "all":
            raise InputError(f"compute pe must use group all, got {group}; compute pe/atom and reduce give the energy of a group")
        super().__init__(group, terms)

    def scalar(self, state) -> float:
        """The sum of the terms."""
        terms = self.terms or tuple(TERMS)
        energy = sum(state.result.energy.get(key, 0.0) for term in TERMS if term in terms for key in TERMS[term])
        if "fix" in terms:
            energy += sum(fix.scalar() for fix in state.fixes if fix.thermo_energy)
        return float(energy)
