r"""Shape of each chunk, from the eigenvalues of the tensors of a compute gyration/chunk.

The columns are those of compute gyration/shape: three eigenvalues, largest first, asphericity, acylindricity, relative shape anisotropy.

Source: D. N. Theodorou, U. W. Suter, Macromolecules 18, 1206 (1985); LAMMPS manual, compute gyration/shape/chunk. Units: distance squared,
the anisotropy none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import shape
from asemd.errors import InputError, nearest
from asemd.words import exactly


class GyrationShapeChunk(Compute):
    """Shape parameters.

    Parameters
    ----------
    group : str
        Not used: the atoms are those of `gyration`.
    gyration : asemd.compute.gyration_chunk.GyrationChunk
        With ``tensor``.
    """

    style = "gyration/shape/chunk"
    columns = 6     # of the array

    def __init__(self, group: str = "all", gyration=None):
        super().__init__(group)
        if getattr(gyration, "style", "") != "gyration/chunk" or not gyration.tensor:
            raise InputError("compute gyration/shape/chunk needs the ID of a compute of style gyration/chunk with keyword tensor")
        self.gyration = gyration

    @property
    def needs(self) -> frozenset[str]:
        return self.gyration.needs

    @classmethod
    def from_lammps(cls, group, words, session):
        id, computes = exactly(words, 1, "compute gyration/shape/chunk (ID of compute gyration/chunk)")[0], session.scene.computes
        if id not in computes:
            raise InputError(f"compute gyration/shape/chunk: there is no compute {id}{nearest(id, computes)}")
        return cls(group, computes[id])

    def to_lammps(self) -> list[str]:
        return [self.gyration.id]

    def array_columns(self) -> int | None:
        return self.columns

    def array(self, state) -> np.ndarray:
        """(chunks, 6) three eigenvalues, asphericity, acylindricity, anisotropy."""
        return shape(self.gyration.pieces(state).gyration())
