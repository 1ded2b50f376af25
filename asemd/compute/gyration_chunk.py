r"""Radius of gyration of each chunk, or with ``tensor`` the tensor whose trace is its square.

.. math:: R_g^2 = \frac{1}{M} \sum_i m_i (\mathbf r_i - \mathbf R)^2

Source: LAMMPS manual, compute gyration/chunk. Units: distance, or distance squared (xx yy zz xy xz yz).
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked
from asemd.errors import InputError, nearest
from asemd.result import COMPONENTS


class GyrationChunk(Chunked):
    """Radii of gyration.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    tensor : bool
        An array of tensors instead of a vector of radii.
    """

    style = "gyration/chunk"
    columns = 6     # of the array

    def __init__(self, group: str = "all", chunks=None, tensor: bool = False):
        super().__init__(group, chunks)
        self.tensor = tensor

    @classmethod
    def from_lammps(cls, group, words, session):
        new = super().from_lammps(group, words[:1], session)
        for word in words[1:]:
            if word != "tensor":
                raise InputError(f"compute gyration/chunk: unknown keyword {word!r}{nearest(word, ['tensor'])}")
            new.tensor = True
        return new

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), *(["tensor"] if self.tensor else [])]

    def vector(self, state) -> np.ndarray:
        """(chunks,) radii."""
        if self.tensor:
            raise InputError(f"compute {self.id} ({self.style} tensor) has an array: write c_{self.id}[1][1]")
        return np.sqrt(np.trace(self.pieces(state).gyration(), axis1=1, axis2=2))

    def array_columns(self) -> int | None:
        return self.columns if self.tensor else None

    def array(self, state) -> np.ndarray:
        """(chunks, 6) xx yy zz xy xz yz."""
        if not self.tensor:
            raise InputError(f"compute {self.id} ({self.style}) has a vector: write c_{self.id}[1]")
        tensors = self.pieces(state).gyration()
        return np.stack([tensors[:, i, j] for i, j in COMPONENTS], axis=1)
