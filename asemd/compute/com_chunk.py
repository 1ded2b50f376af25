r"""Centre of mass of each chunk, of unwrapped positions.

.. math:: \mathbf R = \frac{1}{M} \sum_i m_i \mathbf r_i

Source: LAMMPS manual, compute com/chunk. Units: distance. Columns: x, y, z.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked


class COMChunk(Chunked):
    """Centres of mass."""

    style = "com/chunk"
    columns = 3     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 3) positions; zero for chunks without atoms."""
        return self.pieces(state).com
