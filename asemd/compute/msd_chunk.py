r"""Squared displacement of the centre of mass of each chunk from where it was at the start of the first run after the compute was made.

.. math:: \Delta r^2 = |\mathbf R(t) - \mathbf R(0)|^2

Source: LAMMPS manual, compute msd/chunk. Units: distance squared. Columns: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import SinceStart


class MSDChunk(SinceStart):
    """Squared displacements of centres of mass."""

    style = "msd/chunk"

    def value(self, state) -> np.ndarray:
        return self.pieces(state).com

    def products(self, now: np.ndarray) -> np.ndarray:
        return (now - self.original) ** 2
