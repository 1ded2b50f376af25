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
from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.kernels import observe


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
        self.words, self.terms = tuple(terms or ()), read_terms(terms or (), f"compute {self.style}")
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
        return self._of(state, self.terms, 6)

    def _of(self, state, terms, columns: int) -> np.ndarray:
        """(n, columns): the sixth column is followed by yx zx zy if there are nine."""
        system, u, out = state.system, state.units, np.empty((state.system.n, columns))
        parts = [state.result.virials_of[term] for term in terms if term in state.result.virials_of]
        if set(VIRIAL) <= set(terms):
            total = state.result.virials
        else:
            total = parts[0] if len(parts) == 1 else sum(parts, np.zeros((system.n, 6)))
        if "fix" in terms:
            for fix in state.fixes:
                if fix.thermo_virial:
                    total = total + fix.virials(state)
        v = system.v if self.temperature is None else self.temperature.remove_bias(state)
        observe.stress(v, system.atom_masses(), total, state.mask(self.group), u.mvv2e if "ke" in terms else 0.0, u.nktv2p, out)
        return out
