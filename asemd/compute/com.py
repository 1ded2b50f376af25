r"""Centre of mass of a group, of unwrapped positions.

.. math:: \mathbf R = \frac{1}{M} \sum_i m_i \mathbf r_i

Source: LAMMPS manual, compute com. Units: distance.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import Pieces


class COM(Compute):
    """Centre of mass."""

    style = "com"
    size = 3        # elements of the vector

    def vector(self, state) -> np.ndarray:
        """(3,) position."""
        return Pieces(state.system, state.mask(self.group)).com[0]
