r"""Stress tensor of each atom of a group, times a volume.

.. math:: S_{i,ab} = - m_i v_{ia} v_{ib} - W_{i,ab}

with :math:`W_i` the atom's equal share of the virial of every bond, angle ... pair it is in. It is minus a pressure times a volume: the
sum of xx, yy and zz over all atoms, divided by minus 3 V, is the pressure without the tail correction. Keywords pick terms: ke pair bond
angle dihedral improper kspace fix, or virial for all of them but ke.

Source: LAMMPS manual, compute stress/atom. Units: pressure times volume.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute.pressure import VIRIAL, find_temperature, read_terms
from asemd.compute.temp import COMPONENTS, Temp
from asemd.errors import InputError


class StressAtom(Compute):
    """Stress per atom.

    Parameters
    ----------
    group : str
        The atoms it reports; partners outside the group count.
    temperature : Temp, optional
        A temperature compute whose bias (a streaming velocity) is left out of the kinetic part; None: the velocities as they are.
    terms : sequence of str, optional
        Some of ke, pair, bond, angle, dihedral, improper, kspace, fix, virial; None: all.

    Raises
    ------
    InputError
        An unknown term.
    """

    style = "stress/atom"

    def __init__(self, group: str = "all", temperature: Temp | None = None, terms=None):
        super().__init__(group)
        self.words, self.terms = tuple(terms or ()), read_terms(terms, f"compute {self.style}")
        self.temperature = temperature
        self.needs = frozenset({"virial", "virials"}) if set(self.terms) - {"ke"} else frozenset()

    @classmethod
    def from_lammps(cls, group, words, session):
        if not words:
            raise InputError(f"compute {cls.style} needs the ID of a temperature compute, or NULL")
        return cls(group, None if words[0] == "NULL" else find_temperature(words[0], session, f"compute {cls.style}"), words[1:])

    def to_lammps(self) -> list[str]:
        return [self.temperature.id if self.temperature else "NULL", *self.words]

    def per_atom_columns(self) -> int:
        return 6

    def per_atom(self, state) -> np.ndarray:
        """(n, 6) xx yy zz xy xz yz; zero outside the group."""
        total = np.zeros((state.system.n, 6))
        if "ke" in self.terms:
            mass, v = state.system.atom_masses(), state.system.v if self.temperature is None else self.temperature.remove_bias(state)
            total += state.units.mvv2e * np.stack([mass * v[:, i] * v[:, j] for i, j in COMPONENTS], axis=1)
        if set(VIRIAL) <= set(self.terms):
            total += state.result.virials
        else:
            of = state.result.virials_of
            total += sum((of[term] for term in self.terms if term in of), np.zeros_like(total))
        if "fix" in self.terms:
            for fix in state.fixes:
                if fix.thermo_virial:
                    total += fix.virials(state)
        return np.where(state.mask(self.group)[:, None], -state.units.nktv2p * total, 0.0)
