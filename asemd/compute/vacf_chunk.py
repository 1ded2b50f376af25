r"""Velocity of the centre of mass of each chunk times that at the start of the first run after the compute was made.

.. math:: \mathbf V(0) \cdot \mathbf V(t)

Source: LAMMPS manual, compute vacf/chunk. Units: velocity squared. Columns: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import SinceStart


class VACFChunk(SinceStart):
    """Velocity autocorrelations of centres of mass."""

    style = "vacf/chunk"

    def value(self, state) -> np.ndarray:
        return self.pieces(state).vcm

    def products(self, now: np.ndarray) -> np.ndarray:
        return now * self.original
