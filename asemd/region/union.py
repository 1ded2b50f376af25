"""``region ID union N reg-ID1 reg-ID2 ...``: what lies in any of several regions."""
from __future__ import annotations

from copy import copy

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

    def surface(self, x, cutoff):
        """See `Region.surface`; of the surface of each region only what is on that of the whole. Edges that jut into the region are no part
        of it, as in LAMMPS."""
        if self.open_faces:
            return super().surface(x, cutoff)
        regions, union = self.regions, self.style == "union"
        if self.side == "out":       # outside of a union is what lies outside of all
            regions, union = [copy(r) for r in regions], not union
            for r in regions:
                r.side = "out" if r.side == "in" else "in"
        index, d = [], []
        for r in regions:
            rows, away = r.surface(x, cutoff)
            at = x[rows] - away
            others = [other.inside(at) for other in regions if other is not r]
            keep = ~np.logical_or.reduce(others) if union else np.logical_and.reduce(others)
            index.append(rows[keep])
            d.append(away[keep])
        return np.concatenate(index), np.concatenate(d)

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
        region.session = session if region.varies else None
        return region

    @property
    def varies(self):
        return any(r.varies for r in self.regions)
