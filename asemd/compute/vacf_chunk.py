r"""Velocity of the centre of mass of each chunk times that at the start of the first run after the compute was made.

.. math:: \mathbf V(0) \cdot \mathbf V(t)

Source: LAMMPS manual, compute vacf/chunk. Units: velocity squared. Columns: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked
from asemd.errors import InputError


class VACFChunk(Chunked):
    """Velocity autocorrelations of centres of mass."""

    style = "vacf/chunk"
    columns = 4     # of the array

    def __init__(self, group: str = "all", chunks=None):
        super().__init__(group, chunks)
        self.original: np.ndarray | None = None

    def setup(self, state) -> None:
        """At the start of the first run: the velocities of now are the original ones."""
        if self.original is None:
            self.original = self.pieces(state).vcm

    def array(self, state) -> np.ndarray:
        """(chunks, 4) x, y, z and their sum.

        Raises
        ------
        InputError
            The number of chunks is not that of the start.
        """
        self.setup(state)
        now = self.pieces(state).vcm
        if len(now) != len(self.original):
            raise InputError(f"compute {self.id} ({self.style}): there were {len(self.original)} chunks, now {len(now)}; "
                             "let compute chunk/atom have nchunk once")
        products = now * self.original
        return np.column_stack([products, products.sum(axis=1)])
