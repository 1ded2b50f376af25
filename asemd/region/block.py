"""``region ID block xlo xhi ylo yhi zlo zhi``: an axis-aligned box."""
from __future__ import annotations

import numpy as np

from asemd.kernels import inside
from asemd.region import Region, found, limits


class Block(Region):
    """An axis-aligned box from `lo` to `hi`, both (3,)."""

    style = "block"
    arguments = 6

    def __init__(self, lo, hi, side: str = "in"):
        super().__init__(side)
        self.lo, self.hi = np.array(lo, dtype=float), np.array(hi, dtype=float)

    def contains(self, x):
        return found(inside.block, x, self.lo, self.hi)

    def faces(self, x):
        rows = np.flatnonzero(self.contains(x))
        return [(rows, (x[rows] - face) * axis) for face in (self.lo, self.hi) for axis in np.eye(3)]

    def nearest(self, x):
        return np.clip(x, self.lo, self.hi)

    def bounds(self):
        return self.lo, self.hi

    @classmethod
    def parse(cls, words, spacings, side, session):
        return cls(*limits(words, range(3), spacings, session, "region block"), side=side)
