"""Crystal structure around each atom by common neighbour analysis: 1 fcc, 2 hcp, 3 bcc, 4 icosahedral, 5 none of them.

Source: LAMMPS manual, compute cna/atom; Faken and Jonsson, Comput. Mater. Sci. 2, 279 (1994). No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import half, within_force_cutoff
from asemd.errors import InputError
from asemd.kernels import order
from asemd.words import exactly, number


class CNAAtom(Compute):
    """Common neighbour analysis.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    cutoff : float
        Neighbours are closer than this, between the first and the second shell (bcc: the second and the third); distance units.

    Raises
    ------
    InputError
        A negative cutoff.
    """

    style = "cna/atom"

    def __init__(self, group: str = "all", cutoff: float = 1.0):
        super().__init__(group)
        if cutoff < 0.0:
            raise InputError(f"compute cna/atom: the cutoff must not be negative, got {cutoff:g}")
        self.cutoff = cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, number(exactly(words, 1, "compute cna/atom")[0], "compute cna/atom: cutoff"))

    def to_lammps(self) -> list[str]:
        return [repr(self.cutoff)]

    def per_atom(self, state) -> np.ndarray:
        """(n,) 1 to 5; 0 outside the group."""
        n, out = state.system.n, np.zeros(state.system.n)
        start, _, vector, _ = half(state, within_force_cutoff(state, self.cutoff, "compute cna/atom")).around(n)
        order.common_neighbors(np.flatnonzero(state.mask(self.group)), start, vector, self.cutoff**2, out)
        return out
