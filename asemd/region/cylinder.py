"""``region ID cylinder dim c1 c2 radius lo hi``: a cylinder along an axis."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.region.cone import Cone


class Cylinder(Cone):
    """A cylinder along `axis` (0, 1, 2) from `lo` to `hi`; `center` (2,) holds its place in the two other directions."""

    style = "cylinder"
    arguments = 6

    def __init__(self, axis: int, center, radius: float, lo: float, hi: float, side: str = "in"):
        super().__init__(axis, center, radius, radius, lo, hi, side)

    @classmethod
    def parse(cls, words, spacings, side, session):
        axis, center, (radius,), lo, hi = cls.read(words, spacings, session)
        if radius == 0.0:
            raise InputError("region cylinder: the radius must be positive")
        return cls(axis, center, radius, lo, hi, side=side)
