r"""Tensor of inertia of each chunk about its centre of mass.

.. math:: I_{ab} = \sum_i m_i \left( \delta_{ab}\, d_i^2 - d_{ia} d_{ib} \right), \qquad \mathbf d_i = \mathbf r_i - \mathbf R

Source: LAMMPS manual, compute inertia/chunk. Units: mass times distance squared. Columns: xx yy zz xy yz xz.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked

ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


class InertiaChunk(Chunked):
    """Tensors of inertia."""

    style = "inertia/chunk"
    columns = 6     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 6) xx yy zz xy yz xz."""
        tensors = self.pieces(state).inertia()
        return np.stack([tensors[:, i, j] for i, j in ORDER], axis=1)
