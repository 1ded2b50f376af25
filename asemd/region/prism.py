"""``region ID prism xlo xhi ylo yhi zlo zhi xy xz yz``: a tilted box."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.kernels import inside
from asemd.region import Region, found, limits
from asemd.words import BIG, number


class Prism(Region):
    """A parallelepiped with edges (xhi - xlo, 0, 0), (xy, yhi - ylo, 0), (xz, yz, zhi - zlo) from `lo` (3,); `tilt` is (xy, xz, yz)."""

    style = "prism"
    arguments = 9

    def __init__(self, lo, hi, tilt, side: str = "in"):
        super().__init__(side)
        self.lo, self.hi, self.tilt = (np.array(v, dtype=float) for v in (lo, hi, tilt))
        if np.any(self.hi <= self.lo):
            raise InputError("region prism: every lower bound must be below its upper bound")
        xy, xz, yz = self.tilt
        for tilt_, name, axes in ((xy, "xy", (0, 1)), (xz, "xz", (0, 2)), (yz, "yz", (1, 2))):
            if tilt_ != 0.0 and any(self.lo[k] == -BIG and self.hi[k] == BIG for k in axes):
                raise InputError(f"region prism: with tilt {name} both directions need bounds other than INF")
        length = self.hi - self.lo
        self.cell = np.array([[length[0], 0.0, 0.0], [xy, length[1], 0.0], [xz, yz, length[2]]])

    def contains(self, x):
        return found(inside.prism, x, self.lo, self.cell)

    def _finite(self):
        if np.any(np.abs([self.lo, self.hi]) >= BIG):
            raise InputError(f"region {self.id} (style prism): the surface of a prism with bounds INF is not supported; use block")

    def faces(self, x):
        self._finite()
        rows, out = np.flatnonzero(self.contains(x)), []
        for k in range(3):
            normal = np.cross(self.cell[(k + 1) % 3], self.cell[(k + 2) % 3])
            normal /= np.sqrt(normal @ normal)
            for corner in (self.lo, self.lo + self.cell[k]):
                out.append((rows, ((x[rows] - corner) @ normal)[:, None] * normal))
        return out

    def nearest(self, x):
        self._finite()
        best, point = np.full(len(x), np.inf), np.zeros_like(x)

        def offer(p, valid=True):
            square = ((x - p) ** 2).sum(axis=1)
            better = (square < best) & valid
            point[better], best[better] = p[better], square[better]
        for k in range(3):
            a, b, c = self.cell[k], self.cell[(k + 1) % 3], self.cell[(k + 2) % 3]
            for corner in (self.lo, self.lo + a):
                d = x - corner
                s = d @ np.linalg.pinv(np.array([b, c]))       # where the foot of the perpendicular is on the face
                offer(corner + s @ np.array([b, c]), ((s >= 0.0) & (s <= 1.0)).all(axis=1))
            for start in (self.lo, self.lo + b, self.lo + c, self.lo + b + c):      # the edges along a
                offer(start + np.clip((x - start) @ a / (a @ a), 0.0, 1.0)[:, None] * a)
        return point

    def bounds(self):
        corners = self.lo + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ self.cell
        return corners.min(axis=0), corners.max(axis=0)

    @classmethod
    def parse(cls, words, spacings, side, session):
        lo, hi = limits(words, range(3), spacings, session, "region prism")
        xy, xz, yz = (number(w, "region prism") for w in words[6:9])
        return cls(lo, hi, (xy * spacings[0], xz * spacings[0], yz * spacings[1]), side=side)
