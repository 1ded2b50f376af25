r"""Mean squared displacement of a group from where its atoms were when the compute was made, of unwrapped positions.

.. math:: \langle \Delta r^2 \rangle = \frac1N \sum_i |\mathbf r_i(t) - \mathbf r_i(0)|^2

With ``com yes`` the drift of the centre of mass is left out; with ``average yes`` displacements are those from the mean position of all
times at which this compute was evaluated.

Source: LAMMPS manual, compute msd. Units: distance squared. Vector: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._original import Original, unwrapped
from asemd.compute._pieces import Pieces
from asemd.errors import InputError, nearest
from asemd.kernels import observe
from asemd.words import take, yes_no


class MSD(Compute):
    """Mean squared displacement.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    com, average : bool
        Leave out the drift; take mean positions for the original ones.
    """

    style = "msd"
    size = 4        # elements of the vector
    KEYWORDS = ("com", "average")

    def __init__(self, group: str = "all", com: bool = False, average: bool = False):
        super().__init__(group)
        self.com, self.average = com, average
        self.original: Original | None = None
        self.samples, self.seen = 0, None

    @classmethod
    def from_lammps(cls, group, words, session):
        flags, what = {}, f"compute {cls.style}"
        while words:
            if words[0] not in cls.KEYWORDS:
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], cls.KEYWORDS)}")
            flags[words[0]] = yes_no(take(words[1:], 1, f"{what} {words[0]}")[0], f"{what} {words[0]}")
            words = words[2:]
        new = cls(group, **flags)
        new.start(session.scene.need_system(what), session.scene.groups.mask(group))
        return new

    def to_lammps(self) -> list[str]:
        return ["com", "yes"] * self.com + ["average", "yes"] * self.average

    def start(self, system, mask: np.ndarray) -> None:
        """The positions of now are the original ones."""
        self.original, self.samples, self.seen = Original(system, self._positions(system, mask)), 0, None

    def setup(self, state) -> None:
        """The first step of a run counts again for the mean, as in LAMMPS."""
        self.seen = None

    def _positions(self, system, mask: np.ndarray) -> np.ndarray:
        return unwrapped(system) - Pieces(system, mask).com[0] if self.com else unwrapped(system)

    def displacements(self, state) -> np.ndarray:
        """(m, 3) of the atoms of the group."""
        system, mask = state.system, state.mask(self.group)
        if self.original is None:
            self.start(system, mask)
        now = self._positions(system, mask)
        before = self.original.of(system, now)
        if self.average:
            if self.seen != state.step:     # asked twice on one step, it counts once
                self.samples, self.seen = self.samples + 1, state.step
                before = (before * self.samples + now) / (self.samples + 1)
                self.original.update(system, before)
        return now - before if mask.all() else (now - before)[mask]

    def vector(self, state) -> np.ndarray:
        """(4,) mean squares along x, y, z and in all."""
        system, mask = state.system, state.mask(self.group)
        if self.average or self.original is None or not self.original.holds(system):
            d = self.displacements(state)
            squares, n = np.einsum("ia,ia->a", d, d), len(d)
        else:
            squares, n, drift = np.empty(3), np.count_nonzero(mask), Pieces(system, mask).com[0] if self.com else np.zeros(3)
            observe.displacement(system.x, system.image, system.box.cell, drift, self.original.rows, mask, squares)
        squares /= max(n, 1)
        return np.array([*squares, squares.sum()])
