r"""Angular velocity of each chunk; zero about axes without inertia.

.. math:: \boldsymbol\omega = I^{-1} \mathbf L

Source: LAMMPS manual, compute omega/chunk. Units: 1/time. Columns: x, y, z.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked


class OmegaChunk(Chunked):
    """Angular velocities."""

    style = "omega/chunk"
    columns = 3     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 3) angular velocities."""
        return self.pieces(state).omega()
