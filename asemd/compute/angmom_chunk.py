r"""Angular momentum of each chunk about its centre of mass.

.. math:: \mathbf L = \sum_i m_i (\mathbf r_i - \mathbf R) \times \mathbf v_i

Source: LAMMPS manual, compute angmom/chunk. Units: mass times distance times velocity. Columns: x, y, z.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked


class AngmomChunk(Chunked):
    """Angular momenta."""

    style = "angmom/chunk"
    columns = 3     # of the array

    def array(self, state) -> np.ndarray:
        """(chunks, 3) angular momenta."""
        return self.pieces(state).angular_momentum()
