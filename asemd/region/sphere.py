"""``region ID sphere x y z radius``"""
from __future__ import annotations

import numpy as np

from asemd.kernels import inside
from asemd.region import Region, found, radius
from asemd.words import number


class Sphere(Region):
    """A ball around `center` (3,)."""

    style = "sphere"
    arguments = 4

    def __init__(self, center, radius: float, side: str = "in"):
        super().__init__(side)
        self.center, self.radius = np.array(center, dtype=float), float(radius)

    def contains(self, x):
        return found(inside.sphere, x, self.center, self.radius)

    def faces(self, x):
        d = x - self.center
        r = np.sqrt((d * d).sum(axis=1))
        rows = np.flatnonzero((r <= self.radius) & (r > 0.0))
        return [(rows, d[rows] * (1.0 - self.radius / r[rows])[:, None])]

    def nearest(self, x):
        d = x - self.center
        return self.center + d * (self.radius / np.sqrt((d * d).sum(axis=1)))[:, None]

    def bounds(self):
        return self.center - self.radius, self.center + self.radius

    @classmethod
    def parse(cls, words, spacings, side, session):
        center = [number(w, "region sphere") * s for w, s in zip(words, spacings)]
        return cls(center, radius(words[3], spacings[0], "region sphere"), side=side)
