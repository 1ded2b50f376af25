r"""Velocity of the centre of mass of each chunk.

.. math:: \mathbf V = \frac{1}{M} \sum_i m_i \mathbf v_i

Source: LAMMPS manual, compute vcm/chunk. Units: velocity. Columns: x, y, z.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked


class VCMChunk(Chunked):
    """Velocities of centres of mass."""

    style = "vcm/chunk"
    columns = 3     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 3) velocities."""
        return self.pieces(state).vcm
