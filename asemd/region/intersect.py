"""``region ID intersect N reg-ID1 reg-ID2 ...``: what lies in all of several regions."""
from __future__ import annotations

import numpy as np

from asemd.region.union import Union


class Intersect(Union):
    """Points inside all of `regions`."""

    style = "intersect"
    join = staticmethod(np.logical_and)

    def bounds(self):
        boxes = [b for b in (r.extent() for r in self.regions) if b is not None]
        if not boxes:
            return None
        return np.max([lo for lo, _ in boxes], axis=0), np.min([hi for _, hi in boxes], axis=0)
