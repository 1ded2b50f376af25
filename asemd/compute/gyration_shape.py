r"""Shape of a group, from the eigenvalues of the gyration tensor of a compute gyration.

.. math:: b = l_1 - \tfrac12 (l_2 + l_3), \qquad c = l_2 - l_3, \qquad
          k = \frac32 \frac{l_1^2 + l_2^2 + l_3^2}{(l_1 + l_2 + l_3)^2} - \frac12

The vector has the eigenvalues, largest first, the asphericity b, the acylindricity c and the relative shape anisotropy k.

Source: D. N. Theodorou, U. W. Suter, Macromolecules 18, 1206 (1985); LAMMPS manual, compute gyration/shape. Units: distance squared; k has
none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import shape
from asemd.errors import InputError, nearest
from asemd.words import exactly


class GyrationShape(Compute):
    """Shape parameters.

    Parameters
    ----------
    group : str
        Not used: the atoms are those of `gyration`.
    gyration : asemd.compute.gyration.Gyration
    """

    style = "gyration/shape"
    size = 6        # elements of the vector

    def __init__(self, group: str = "all", gyration=None):
        super().__init__(group)
        if getattr(gyration, "style", "") != "gyration":
            raise InputError("compute gyration/shape needs the ID of a compute of style gyration")
        self.gyration = gyration

    @classmethod
    def from_lammps(cls, group, words, session):
        id, computes = exactly(words, 1, "compute gyration/shape (ID of compute gyration)")[0], session.scene.computes
        if id not in computes:
            raise InputError(f"compute gyration/shape: there is no compute {id}{nearest(id, computes)}")
        return cls(group, computes[id])

    def to_lammps(self) -> list[str]:
        return [self.gyration.id]

    def vector(self, state) -> np.ndarray:
        """(6,) three eigenvalues, b, c, k."""
        return shape(self.gyration.tensor(state)[None])[0]
