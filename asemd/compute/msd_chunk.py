r"""Squared displacement of the centre of mass of each chunk from where it was at the start of the first run after the compute was made.

.. math:: \Delta r^2 = |\mathbf R(t) - \mathbf R(0)|^2

Source: LAMMPS manual, compute msd/chunk. Units: distance squared. Columns: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked
from asemd.errors import InputError


class MSDChunk(Chunked):
    """Squared displacements of centres of mass."""

    style = "msd/chunk"
    columns = 4     # of the array

    def __init__(self, group: str = "all", chunks=None):
        super().__init__(group, chunks)
        self.original: np.ndarray | None = None

    def setup(self, state) -> None:
        """At the start of the first run: the positions of now are the original ones."""
        if self.original is None:
            self.original = self.pieces(state).com

    def array(self, state) -> np.ndarray:
        """(chunks, 4) x, y, z and their sum.

        Raises
        ------
        InputError
            The number of chunks is not that of the start.
        """
        self.setup(state)
        now = self.pieces(state).com
        if len(now) != len(self.original):
            raise InputError(f"compute {self.id} ({self.style}): there were {len(self.original)} chunks, now {len(now)}; "
                             "let compute chunk/atom have nchunk once")
        d = now - self.original
        products = d * d
        return np.column_stack([products, products.sum(axis=1)])
