r"""Regions of space. One region style, one file; each is a class with ``inside(x)``.

Points on the boundary are inside the geometry: they belong to ``side in`` and not to ``side out``. Regions are not wrapped across periodic
boundaries.
"""
from __future__ import annotations

from typing import ClassVar

import numpy as np

from asemd.errors import InputError
from asemd.words import BIG, choice, number, take


class Region:
    """Base class of regions.

    Parameters
    ----------
    side : str
        ``in`` or ``out``.
    """

    style: ClassVar[str] = ""
    arguments: ClassVar[int] = 0
    id: str = ""

    def __init__(self, side: str = "in"):
        self.side = side

    def contains(self, x: np.ndarray) -> np.ndarray:
        """Whether points are inside the geometry, whatever the side: (n, 3) -> (n,) bool."""
        raise NotImplementedError

    def bounds(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Lowest and highest corner of a box around the geometry; None if it has no end."""
        raise NotImplementedError

    def inside(self, x: np.ndarray) -> np.ndarray:
        """Whether points belong to the region.

        Parameters
        ----------
        x : (n, 3) float array
            Positions, distance units.

        Returns
        -------
        (n,) bool array
        """
        found = self.contains(np.asarray(x, dtype=float))
        return found if self.side == "in" else ~found

    def extent(self) -> tuple[np.ndarray, np.ndarray] | None:
        """`bounds` of the region itself: None for ``side out``."""
        return self.bounds() if self.side == "in" else None

    @classmethod
    def from_lammps(cls, words: list[str], session) -> Region:
        """Build from the words after the style's name in ``region ID style words...``.

        Raises
        ------
        InputError
            Wrong number of words, unknown or unsupported keyword, impossible geometry.
        """
        take(words, cls.arguments, f"region {cls.style}")
        lattice, side = options(words[cls.arguments:], cls.style)
        spacings = np.ones(3)
        if lattice and session.scene.lattice is not None:
            spacings = session.scene.lattice.spacings
        return cls.parse(words[:cls.arguments], spacings, side, session)

    @classmethod
    def parse(cls, words: list[str], spacings: np.ndarray, side: str, session) -> Region:
        """From the style's own words; lengths are multiplied by `spacings`."""
        raise NotImplementedError


def options(words: list[str], style: str) -> tuple[bool, str]:
    """The trailing keywords: whether lengths are in lattice units, and the side."""
    lattice, side = True, "in"
    while words:
        key, what = words[0], f"region {style} {words[0]}"
        if key in ("move", "rotate", "open"):
            raise InputError(f"{what} is not supported: use a fixed region with closed faces")
        if key not in ("side", "units"):
            raise InputError(f"region {style}: unknown keyword {key!r}, there are side and units")
        value = take(words[1:], 1, what)[0]
        if key == "side":
            side = choice(value, ("in", "out"), what)
        else:
            lattice = choice(value, ("lattice", "box"), what) == "lattice"
        words = words[2:]
    return lattice, side


def limit(word: str, axis: int, upper: bool, spacing: float, session, what: str) -> float:
    """A face: a number times the spacing, INF or EDGE."""
    if word not in ("INF", "EDGE"):
        return number(word, what) * spacing
    system = session.scene.system
    if system is None:
        raise InputError(f"{what}: {word} needs the simulation box, which is not defined yet")
    if word == "INF":
        return BIG if upper else -BIG
    corners = system.box.origin + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ system.box.cell
    return float(corners[:, axis].max() if upper else corners[:, axis].min())


def limits(words: list[str], axes, spacings, session, what: str) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of faces ``lo hi lo hi ...``, one pair per axis."""
    lo, hi = [], []
    for n, axis in enumerate(axes):
        a = limit(words[2 * n], axis, False, spacings[axis], session, what)
        b = limit(words[2 * n + 1], axis, True, spacings[axis], session, what)
        if a > b:
            raise InputError(f"{what}: lower bound {words[2 * n]} is above upper bound {words[2 * n + 1]} in {'xyz'[axis]}")
        lo.append(a)
        hi.append(b)
    return np.array(lo), np.array(hi)


def radius(word: str, spacing: float, what: str) -> float:
    """A radius, not negative."""
    if word.startswith("v_"):
        raise InputError(f"{what}: a variable radius is not supported, give a number")
    value = number(word, what) * spacing
    if value < 0.0:
        raise InputError(f"{what}: radius must not be negative, got {word}")
    return value
