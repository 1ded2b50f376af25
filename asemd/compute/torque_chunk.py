r"""Torque on each chunk about its centre of mass.

.. math:: \mathbf T = \sum_i (\mathbf r_i - \mathbf R) \times \mathbf F_i

Source: LAMMPS manual, compute torque/chunk. Units: force times distance. Columns: x, y, z.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked


class TorqueChunk(Chunked):
    """Torques."""

    style = "torque/chunk"
    columns = 3     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 3) torques."""
        return self.pieces(state).torque()
