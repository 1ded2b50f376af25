r"""Radius of gyration of a group, of unwrapped positions, and the tensor whose trace is its square.

.. math:: R_g^2 = \frac{1}{M} \sum_i m_i (\mathbf r_i - \mathbf R)^2, \qquad
          S_{ab} = \frac{1}{M} \sum_i m_i (r_{ia} - R_a)(r_{ib} - R_b)

Source: LAMMPS manual, compute gyration. Units: distance; the tensor (xx yy zz xy xz yz) distance squared.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import Pieces
from asemd.result import COMPONENTS


class Gyration(Compute):
    """Radius of gyration."""

    style = "gyration"
    size = 6        # elements of the vector

    def tensor(self, state) -> np.ndarray:
        """(3, 3) gyration tensor."""
        return Pieces(state.system, state.mask(self.group)).gyration()[0]

    def scalar(self, state) -> float:
        """The radius."""
        return float(np.sqrt(np.trace(self.tensor(state))))

    def vector(self, state) -> np.ndarray:
        """(6,) xx yy zz xy xz yz."""
        tensor = self.tensor(state)
        return np.array([tensor[c] for c in COMPONENTS])
