r"""Centrosymmetry parameter of each atom: how far its surroundings are from having a centre.

.. math:: CS = \sum_{i=1}^{N/2} |\mathbf r_i + \mathbf r_{i+N/2}|^2

over the N/2 pairs of the N nearest neighbours with the smallest values. Axes lie along the two pairs with the smallest ones; their sense
is arbitrary. Source: LAMMPS manual, compute centro/atom; Kelchner, Plimpton,
Hamilton, Phys. Rev. B 58, 11085 (1998). Units: distance squared.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half
from asemd.errors import InputError
from asemd.kernels import order
from asemd.words import take, whole, yes_no

NEIGHBORS = {"fcc": 12, "bcc": 8}


class CentroAtom(Compute):
    """Centrosymmetry.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    neighbors : int or str
        Even; ``fcc`` is 12, ``bcc`` is 8.
    axes : bool
        Three axes of symmetry too.

    Raises
    ------
    InputError
        An odd number of neighbours, or none.
    """

    style = "centro/atom"

    def __init__(self, group: str = "all", neighbors: int | str = "fcc", axes: bool = False):
        super().__init__(group)
        self.count, self.axes = NEIGHBORS.get(neighbors, neighbors), axes
        if not isinstance(self.count, int) or self.count <= 0 or self.count % 2:
            raise InputError(f"compute centro/atom: neighbours must be fcc, bcc or an even positive number, got {neighbors}")

    @classmethod
    def from_lammps(cls, group, words, session):
        name, rest = take(words, 1, "compute centro/atom")[0], list(words[1:])
        axes = False
        while rest:
            if rest[0] != "axes":
                raise InputError(f"compute centro/atom: unknown keyword {rest[0]!r} (did you mean axes?)")
            axes, rest = yes_no(take(rest[1:], 1, "compute centro/atom axes")[0], "compute centro/atom axes"), rest[2:]
        return cls(group, name if name in NEIGHBORS else whole(name, "compute centro/atom: neighbours"), axes)

    def to_lammps(self) -> list[str]:
        return [str(self.count), *["axes", "yes"] * self.axes]

    def per_atom_columns(self) -> int:
        return 10 if self.axes else 0

    def per_atom(self, state) -> np.ndarray:
        """(n,), or (n, 10) with three axes; zero outside the group and for atoms with too few neighbours."""
        n = state.system.n
        start, _, vector, square = half(state, force_cutoff(state, "compute centro/atom")).around(n)
        out, axes = np.zeros(n), np.zeros((n if self.axes else 0, 3, 3))
        order.centrosymmetry(np.flatnonzero(state.mask(self.group)), start, vector, square, self.count, out, axes)
        return np.column_stack([out, axes.reshape(n, 9)]) if self.axes else out
