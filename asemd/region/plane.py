"""``region ID plane px py pz nx ny nz``: the half space a normal points into."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.kernels import inside
from asemd.region import Region, found
from asemd.words import number


class Plane(Region):
    """The half space in the direction of `normal` (3,) from `point` (3,)."""

    style = "plane"
    arguments = 6

    def __init__(self, point, normal, side: str = "in"):
        super().__init__(side)
        self.point, self.normal = np.array(point, dtype=float), np.array(normal, dtype=float)
        length = np.sqrt(self.normal @ self.normal)
        if length == 0.0:
            raise InputError("region plane: the normal must not be zero")
        self.normal /= length

    def contains(self, x):
        return found(inside.plane, x, self.point, self.normal)

    def faces(self, x):
        rows = np.flatnonzero(self.contains(x))
        return [(rows, x[rows] - self.nearest(x[rows]))]

    def nearest(self, x):
        return x - ((x - self.point) @ self.normal)[:, None] * self.normal

    def bounds(self):
        return None

    @classmethod
    def parse(cls, words, spacings, side, session):
        values = [number(w, "region plane") for w in words]
        return cls(values[:3] * spacings, values[3:] * spacings, side=side)
