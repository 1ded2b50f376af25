"""Exchange between pairs of atoms in two layers of the box, as Mueller-Plathe's methods do it."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix


class Exchange(Fix):
    """Base class of fixes that swap something between the first layer and the middle one, every N steps.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two exchanges.
    along : int
        Direction of the layers: 0 x, 1 y, 2 z.
    bins : int
        Number of layers, even.
    swaps : int
        Pairs of atoms in each exchange.
    """

    extensive = False

    def __init__(self, group: str, every: int, along: int, bins: int, swaps: int):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix {self.style}: N must be at least 1, got {every}")
        if bins % 2 or bins < self.fewest:
            raise InputError(f"fix {self.style}: Nbin must be an even number of at least {self.fewest}, got {bins}")
        if swaps < 1:
            raise InputError(f"fix {self.style}: swap must be at least 1, got {swaps}")
        self.every, self.along, self.bins, self.swaps, self.exchanged = every, along, bins, swaps, 0.0

    fewest = 2

    def layers(self, loop) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the atoms of the group in the first layer and in the middle one."""
        loop.sync_out()
        box, k = loop.system.box, self.along
        lo, length = box.origin[k], box.cell[k, k]
        hi, z = lo + length, loop.system.x[:, k]
        if box.periodic[k]:
            z = np.where(z < lo, z + length, np.where(z >= hi, z - length, z))
        half = self.bins // 2
        mask = loop.groups[self.group]
        return (np.flatnonzero(mask & (z >= lo) & (z < lo + length / self.bins)),
                np.flatnonzero(mask & (z >= lo + half * length / self.bins) & (z < lo + (half + 1) * length / self.bins)))

    def first(self, rows: np.ndarray, keys: np.ndarray) -> np.ndarray:
        """The rows of the smallest keys; of equal ones the last comes first, unless the list is full."""
        best: list[int] = []
        for n, key in enumerate(keys.tolist()):
            if len(best) < self.swaps or key < keys[best[-1]]:
                at = len(best)
                while at and key <= keys[best[at - 1]]:
                    at -= 1
                best.insert(at, n)
                del best[self.swaps:]
        return rows[best]

    def scalar(self) -> float:
        """What was exchanged since the fix was defined."""
        return self.exchanged
