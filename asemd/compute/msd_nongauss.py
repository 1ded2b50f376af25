r"""Mean squared and fourth-power displacement of a group, and the non-Gaussian parameter.

.. math:: \alpha = \frac{3 \langle \Delta r^4 \rangle}{5 \langle \Delta r^2 \rangle^2} - 1

It is zero for Brownian motion. Keyword com and original positions are those of compute msd.

Source: LAMMPS manual, compute msd/nongauss. Units: distance squared, distance to the fourth, none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.msd import MSD


class MSDNonGauss(MSD):
    """Non-Gaussian parameter.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    com : bool
        Leave out the drift of the centre of mass.
    """

    style = "msd/nongauss"
    size = 3        # elements of the vector
    KEYWORDS = ("com",)

    def vector(self, state) -> np.ndarray:
        """(3,) mean square, mean fourth power, non-Gaussian parameter."""
        square = (self.displacements(state) ** 2).sum(axis=1)
        n = max(len(square), 1)
        second, fourth = square.sum() / n, (square * square).sum() / n
        return np.array([second, fourth, 3.0 * fourth / (5.0 * second * second) - 1.0 if second > 0.0 else -1.0])
