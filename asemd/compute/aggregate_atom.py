"""Aggregates of atoms and molecules: each atom gets the smallest ID of the atoms it is connected with by bonds or short distances.

Source: LAMMPS manual, compute aggregate/atom. No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._clusters import bonded, smallest_ids
from asemd.compute._pairs import half, within_force_cutoff
from asemd.errors import InputError
from asemd.words import exactly, number


class AggregateAtom(Compute):
    """Clusters by bonds and distance.

    Parameters
    ----------
    group : str
        Only its atoms form aggregates.
    cutoff : float
        Distance units, at most the cutoff of the pair style.

    Raises
    ------
    InputError
        A negative cutoff, or (from a script) an atom style without bonds.
    """

    style = "aggregate/atom"

    def __init__(self, group: str = "all", cutoff: float = 1.0):
        super().__init__(group)
        if cutoff < 0.0:
            raise InputError(f"compute aggregate/atom: the cutoff must not be negative, got {cutoff:g}")
        self.cutoff = cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        if not session.scene.need_system("compute aggregate/atom").molecular:
            raise InputError(f"compute aggregate/atom needs an atom style with bonds, not {session.scene.atom_style}")
        return cls(group, number(exactly(words, 1, "compute aggregate/atom")[0], "compute aggregate/atom: cutoff"))

    def to_lammps(self) -> list[str]:
        return [repr(self.cutoff)]

    def per_atom(self, state) -> np.ndarray:
        """(n,) IDs; 0 outside the group."""
        pairs, (a, b) = half(state, within_force_cutoff(state, self.cutoff, "compute aggregate/atom")), bonded(state)
        return smallest_ids(state, state.mask(self.group), np.append(pairs.i, a), np.append(pairs.j, b))
