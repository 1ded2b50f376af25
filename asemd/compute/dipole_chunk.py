r"""Dipole moment of each chunk: of its charges, at unwrapped positions, and of its dipoles.

.. math:: \boldsymbol\mu = \sum_i q_i (\mathbf r_i - \mathbf R) + \sum_i \boldsymbol\mu_i

with the centre of mass R, or with ``geometry`` the mean position.

Source: LAMMPS manual, compute dipole/chunk. Units: charge times distance. Columns: x, y, z, length.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked
from asemd.compute.dipole import CENTRES, moments, read_centre
from asemd.words import choice


class DipoleChunk(Chunked):
    """Dipole moments.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    centre : str
        ``mass`` or ``geometry``.
    """

    style = "dipole/chunk"
    columns = 4     # of the array

    def __init__(self, group: str = "all", chunks=None, centre: str = "mass"):
        super().__init__(group, chunks)
        self.centre = choice(centre, CENTRES, "compute dipole/chunk")

    @classmethod
    def from_lammps(cls, group, words, session):
        new = super().from_lammps(group, words[:1], session)
        new.centre = read_centre(words[1:], "compute dipole/chunk")
        return new

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), self.centre]

    def array(self, state) -> np.ndarray:
        """(chunks, 4) moment and its length."""
        moment = moments(self.pieces(state), self.centre)
        return np.column_stack([moment, np.sqrt((moment * moment).sum(axis=1))])
