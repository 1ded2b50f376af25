r"""Dipole moment of a group: of its charges, at unwrapped positions, and of its dipoles.

.. math:: \boldsymbol\mu = \sum_i q_i (\mathbf r_i - \mathbf R) + \sum_i \boldsymbol\mu_i

with the centre of mass R, or with ``geometry`` the mean position; it matters for groups with a net charge only.

Source: LAMMPS manual, compute dipole. Units: charge times distance. The scalar is the length of the vector.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import Pieces
from asemd.errors import InputError
from asemd.words import choice

CENTRES = ("mass", "geometry")


def moments(pieces: Pieces, centre: str) -> np.ndarray:
    """(pieces, 3) dipole moments."""
    system, rows = pieces.system, pieces.rows
    q = np.zeros(len(rows)) if system.q is None else system.q[rows]
    if centre == "mass":
        middle = pieces.com
    else:
        middle = pieces.sum(pieces.x) / np.maximum(pieces.atoms, 1)[:, None]
    total = pieces.sum(q[:, None] * pieces.x) - pieces.sum(q)[:, None] * middle
    return total + pieces.sum(system.extra["mu"][rows]) if "mu" in system.extra else total


def read_centre(words: list[str], what: str) -> str:
    """The optional word ``mass`` or ``geometry``."""
    if len(words) > 1:
        raise InputError(f"{what}: takes one word, mass or geometry, got {' '.join(words)}")
    return choice(words[0], CENTRES, what) if words else "mass"


class Dipole(Compute):
    """Dipole moment.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    centre : str
        ``mass`` or ``geometry``.
    """

    style = "dipole"
    size = 3        # elements of the vector

    def __init__(self, group: str = "all", centre: str = "mass"):
        super().__init__(group)
        self.centre = choice(centre, CENTRES, "compute dipole")

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, read_centre(words, "compute dipole"))

    def to_lammps(self) -> list[str]:
        return [self.centre]

    def vector(self, state) -> np.ndarray:
        """(3,) dipole moment."""
        return moments(Pieces(state.system, state.mask(self.group)), self.centre)[0]

    def scalar(self, state) -> float:
        """Its length."""
        return float(np.linalg.norm(self.vector(state)))
