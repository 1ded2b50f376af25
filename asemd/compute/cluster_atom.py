"""Clusters of atoms: each atom gets the smallest ID of the atoms it is connected with by distances below a cutoff.

Source: LAMMPS manual, compute cluster/atom. No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._clusters import smallest_ids
from asemd.compute._pairs import half, within_force_cutoff
from asemd.errors import InputError
from asemd.words import exactly, number


class ClusterAtom(Compute):
    """Clusters by distance.

    Parameters
    ----------
    group : str
        Only its atoms form clusters.
    cutoff : float
        Distance units, at most the cutoff of the pair style.

    Raises
    ------
    InputError
        A negative cutoff.
    """

    style = "cluster/atom"

    def __init__(self, group: str = "all", cutoff: float = 1.0):
        super().__init__(group)
        if cutoff < 0.0:
            raise InputError(f"compute {self.style}: the cutoff must not be negative, got {cutoff:g}")
        self.cutoff = cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, number(exactly(words, 1, f"compute {cls.style}")[0], f"compute {cls.style}: cutoff"))

    def to_lammps(self) -> list[str]:
        return [repr(self.cutoff)]

    def per_atom(self, state) -> np.ndarray:
        """(n,) IDs; 0 outside the group."""
        pairs = half(state, within_force_cutoff(state, self.cutoff, "compute cluster/atom"))
        return smallest_ids(state, state.mask(self.group), pairs.i, pairs.j)
