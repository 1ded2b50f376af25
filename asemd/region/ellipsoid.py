"""``region ID ellipsoid x y z a b c``: an ellipsoid with its axes along x, y and z."""
from __future__ import annotations

import numpy as np

from asemd.region import Region, radius
from asemd.words import number


class Ellipsoid(Region):
    """An ellipsoid around `center` (3,) with semi-axes `axes` (3,)."""

    style = "ellipsoid"
    arguments = 6

    def __init__(self, center, axes, side: str = "in"):
        super().__init__(side)
        self.center, self.axes = np.array(center, dtype=float), np.array(axes, dtype=float)

    def contains(self, x):
        a, b, c = self.axes
        dx, dy, dz = (x - self.center).T
        return (b * c * dx) ** 2 + (a * c * dy) ** 2 + (a * b * dz) ** 2 <= a * a * b * b * c * c

    def bounds(self):
        return self.center - self.axes, self.center + self.axes

    @classmethod
    def parse(cls, words, spacings, side, session):
        center = [number(w, "region ellipsoid") * s for w, s in zip(words, spacings)]
        return cls(center, [radius(w, s, "region ellipsoid") for w, s in zip(words[3:], spacings)], side=side)
