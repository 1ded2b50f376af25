"""``region ID cone dim c1 c2 radlo radhi lo hi``: a cone or a part of one, along an axis."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.kernels import inside
from asemd.region import Region, found, limits, radius
from asemd.words import choice, number


def across(axis: int) -> tuple[int, int]:
    """The two other directions, in the order x y z."""
    return ((1, 2), (0, 2), (0, 1))[axis]


def on_segment(r, h, a, b):
    """The points of the segment from `a` to `b` that are nearest to points of a plane: two arrays of coordinates."""
    dr, dh = b[0] - a[0], b[1] - a[1]
    square = dr * dr + dh * dh
    t = np.clip(((r - a[0]) * dr + (h - a[1]) * dh) / square, 0.0, 1.0) if square > 0.0 else 0.0 * r
    return a[0] + t * dr, a[1] + t * dh


class Cone(Region):
    """A cone along `axis` (0, 1, 2) with radii `low` at `lo` and `high` at `hi`; `center` (2,) is its place in the two other directions."""

    style = "cone"
    arguments = 7

    def __init__(self, axis: int, center, low: float, high: float, lo: float, hi: float, side: str = "in"):
        super().__init__(side)
        self.axis, self.center, self.radii = axis, np.array(center, dtype=float), (float(low), float(high))
        self.lo, self.hi = float(lo), float(hi)

    def contains(self, x):
        low, high = self.radii
        slope = (high - low, self.hi - self.lo) if high != low else (0.0, 1.0)
        return found(inside.cone, x, self.axis, *across(self.axis), self.center, low, slope, self.lo, self.hi)

    def polar(self, x):
        """Distance from the axis, unit vectors away from it, and the place along it."""
        a, b = across(self.axis)
        out = np.zeros_like(x)
        out[:, a], out[:, b] = x[:, a] - self.center[0], x[:, b] - self.center[1]
        r = np.sqrt((out * out).sum(axis=1))
        return r, out / np.where(r > 0.0, r, 1.0)[:, None], x[:, self.axis]

    def back(self, r, out, along):
        """Vectors whose parts away from the axis and along it are given."""
        return r[:, None] * out + along[:, None] * np.eye(3)[self.axis]

    def faces(self, x):
        rows = np.flatnonzero(self.contains(x))
        r, out, h = self.polar(x[rows])
        sr, sh = on_segment(r, h, (self.radii[0], self.lo), (self.radii[1], self.hi))
        side = np.flatnonzero(r > 0.0)
        return [(rows[side], self.back(r - sr, out, h - sh)[side]),
                *((rows, self.back(0.0 * h, out, h - end)) for end in (self.lo, self.hi))]

    def nearest(self, x):
        r, out, h = self.polar(x)
        lo, hi = (self.radii[0], self.lo), (self.radii[1], self.hi)
        best, away = np.full(len(x), np.inf), np.zeros_like(x)
        for a, b in (((0.0, self.lo), lo), (lo, hi), (hi, (0.0, self.hi))):
            sr, sh = on_segment(r, h, a, b)
            square = (r - sr) ** 2 + (h - sh) ** 2
            away = np.where((square < best)[:, None], self.back(r - sr, out, h - sh), away)
            best = np.minimum(best, square)
        return x - away

    def bounds(self):
        largest = max(self.radii)
        lo, hi = np.empty(3), np.empty(3)
        lo[self.axis], hi[self.axis] = self.lo, self.hi
        for k, c in zip(across(self.axis), self.center):
            lo[k], hi[k] = c - largest, c + largest
        return lo, hi

    @classmethod
    def read(cls, words, spacings, session):
        """Axis, center, radii, lo and hi from ``dim c1 c2 radius ... lo hi``."""
        what = f"region {cls.style}"
        axis = "xyz".index(choice(words[0], ("x", "y", "z"), what))
        a, b = across(axis)
        center = number(words[1], what) * spacings[a], number(words[2], what) * spacings[b]
        (lo,), (hi,) = limits(words[-2:], [axis], spacings, session, what)
        return axis, center, [radius(w, spacings[a], what) for w in words[3:-2]], lo, hi

    @classmethod
    def parse(cls, words, spacings, side, session):
        axis, center, radii, lo, hi = cls.read(words, spacings, session)
        if radii == [0.0, 0.0] or lo == hi:
            raise InputError("region cone: one radius must be positive and lo must be below hi")
        return cls(axis, center, *radii, lo, hi, side=side)
