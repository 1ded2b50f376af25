"""``region ID union N reg-ID1 reg-ID2 ...``: what lies in any of several regions."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.region import Region, options
from asemd.words import take, whole


class Union(Region):
    """Points inside any of `regions`."""

    style = "union"
    join = staticmethod(np.logical_or)

    def __init__(self, regions, side: str = "in"):
        super().__init__(side)
        self.regions = list(regions)

    def contains(self, x):
        return self.join.reduce([r.inside(x) for r in self.regions])

    def bounds(self):
        boxes = [r.extent() for r in self.regions]
        if any(b is None for b in boxes):
            return None
        return np.min([lo for lo, _ in boxes], axis=0), np.max([hi for _, hi in boxes], axis=0)

    @classmethod
    def from_lammps(cls, words, session):
        what = f"region {cls.style}"
        n = whole(take(words, 1, what)[0], what)
        if n < 2:
            raise InputError(f"{what} needs two regions at least, got {n}")
        regions = [session.scene.region(name, what) for name in take(words[1:], n, what)]
        given = options(words[1 + n:], cls.style, session)
        if given.motion is not None:
            raise InputError(f"{what} cannot move or rotate: let its regions do so")
        region = cls(regions, side=given.side)
        region.open_faces = given.open_faces
        return region

    @property
    def varies(self):
        return any(r.varies for r in self.regions)
