r"""Momentum of a group.

.. math:: \mathbf p = \sum_i m_i \mathbf v_i

Source: LAMMPS manual, compute momentum. Units: mass times velocity, for the whole group (not per atom).
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute


class Momentum(Compute):
    """Momentum."""

    style = "momentum"
    size = 3        # elements of the vector
    extensive = True

    def vector(self, state) -> np.ndarray:
        """(3,) sum of m v."""
        return np.einsum("i,ij->j", np.where(state.mask(self.group), state.system.atom_masses(), 0.0), state.system.v)
