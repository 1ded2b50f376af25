r"""Regions of space. One region style, one file; each is a class with ``inside(x)``.

Points on the boundary are inside the geometry: they belong to ``side in`` and not to ``side out``. Regions are not wrapped across periodic
boundaries. Where a number may be a variable, the region is read again whenever it is used; a region that moves takes points back by its
displacement and then by its rotation.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from asemd.errors import InputError, nearest
from asemd.region.motion import Motion, move, rotate
from asemd.words import BIG, choice, number, take, whole

FACES = 6
NO_SURFACE = "distances from its surface are not supported; use block, sphere, cylinder, cone, plane or prism, or " \
             "unions and intersections of these"


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
    motion: Motion | None = None
    open_faces: tuple[int, ...] = ()
    source: Source | None = None
    session: Any = None

    def __init__(self, side: str = "in"):
        self.side = side

    @property
    def varies(self) -> bool:
        """Whether the region may be another one on another step."""
        return self.motion is not None or self.source is not None

    def see(self, loop) -> None:
        """In the midst of a run: its variables have their values of the present step of the loop."""
        if self.session is not None:
            loop.system.step = loop.step
            self.session.look(loop)

    def renew(self) -> None:
        """Take the values that its variables have now."""
        if self.source is not None:
            vars(self).update(vars(self.source.read(type(self), self.side)))

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
        x = np.asarray(x, dtype=float, order="F")       # columns in one piece: a hundred times faster to compare
        if self.open_faces:     # LAMMPS counts every point as one of a region with open faces
            return np.ones(len(x), bool)
        self.renew()
        found = self.contains(x if self.motion is None else self.motion.undo(x))
        return found if self.side == "in" else ~found

    def surface(self, x: np.ndarray, cutoff: float) -> tuple[np.ndarray, np.ndarray]:
        """Points of the surface near points of the region.

        Inside (``side in``) each face counts, with the point of it that is nearest; outside only the nearest point of all. Points that are
        not in the region have none.

        Parameters
        ----------
        x : (n, 3) float array
            Positions, distance units.
        cutoff : float
            Points of the surface at this distance and beyond are left out.

        Returns
        -------
        index : (m,) int array
            Which of the positions each point belongs to.
        d : (m, 3) float array
            From the surface to the position.

        Raises
        ------
        InputError
            A style whose surface is not known, open faces.
        """
        if self.open_faces:
            raise InputError(f"region {self.id} (style {self.style}): the surface of a region with open faces is not supported")
        self.renew()
        at = x if self.motion is None else self.motion.undo(x)
        near = (self.faces if self.side == "in" else self.outside)(at)
        index, d = [], []
        for rows, away in near:
            close = (away * away).sum(axis=1) < cutoff * cutoff
            index.append(rows[close])
            d.append(away[close] if self.motion is None else self.motion.turn(away[close]))
        return np.concatenate(index), np.concatenate(d)

    def faces(self, x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each face, which points are inside the geometry and the vectors to them from their nearest points on the face."""
        raise InputError(f"region {self.id} (style {self.style}): {NO_SURFACE}")

    def outside(self, x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Which points are outside the geometry and the vectors to them from their nearest points on the surface."""
        rows = np.flatnonzero(~self.contains(x))
        return [(rows, x[rows] - self.nearest(x[rows]))]

    def nearest(self, x: np.ndarray) -> np.ndarray:
        """(n, 3) the points of the surface that are nearest to points outside the geometry."""
        raise InputError(f"region {self.id} (style {self.style}): {NO_SURFACE}")

    def extent(self) -> tuple[np.ndarray, np.ndarray] | None:
        """`bounds` of the region itself: None for ``side out`` and for regions that vary."""
        return self.bounds() if self.side == "in" and not self.varies else None

    @classmethod
    def from_lammps(cls, words: list[str], session) -> Region:
        """Build from the words after the style's name in ``region ID style words...``.

        Raises
        ------
        InputError
            Wrong number of words, unknown or unsupported keyword, impossible geometry.
        """
        take(words, cls.arguments, f"region {cls.style}")
        given = options(words[cls.arguments:], cls.style, session)
        spacings = np.ones(3)
        if given.lattice and session.scene.lattice is not None:
            spacings = session.scene.lattice.spacings
        source = Source(words[:cls.arguments], spacings, session)
        region = source.read(cls, given.side)
        if any(w.startswith("v_") for w in source.words):
            region.source = source
        if given.motion is not None:
            region.motion = given.motion.scaled(spacings)
        region.open_faces = given.open_faces
        region.session = session if region.varies else None
        return region

    @classmethod
    def parse(cls, words: list[str], spacings: np.ndarray, side: str, session) -> Region:
        """From the style's own words; lengths are multiplied by `spacings`."""
        raise NotImplementedError


@dataclass
class Source:
    """The words of a region's geometry, and the session that knows their variables."""

    words: list[str]
    spacings: np.ndarray
    session: Any

    def read(self, style: type[Region], side: str) -> Region:
        """The region that the words describe now."""
        values = [repr(self.session.variables.number(w[2:])) if w.startswith("v_") else w for w in self.words]
        return style.parse(values, self.spacings, side, self.session)


@dataclass
class Options:
    """The trailing keywords of a region."""

    lattice: bool = True
    side: str = "in"
    motion: Motion | None = None
    open_faces: tuple[int, ...] = ()


def options(words: list[str], style: str, session) -> Options:
    """Read the trailing keywords ``side``, ``units``, ``move``, ``rotate`` and ``open``."""
    out = Options()
    while words:
        key, what = words[0], f"region {style} {words[0]}"
        if key not in KEYWORDS:
            raise InputError(f"region {style}: unknown keyword {key!r}{nearest(key, KEYWORDS)}, there are {' '.join(KEYWORDS)}")
        values = take(words[1:], KEYWORDS[key], what)
        if key == "side":
            out.side = choice(values[0], ("in", "out"), what)
        elif key == "units":
            out.lattice = choice(values[0], ("lattice", "box"), what) == "lattice"
        elif key == "open":
            face = whole(values[0], what)
            if not 1 <= face <= FACES:
                raise InputError(f"{what}: face {face} is outside the valid range 1 to {FACES}")
            out.open_faces = (*out.open_faces, face)
        else:
            out.motion = out.motion or Motion(session.variables.number)
            (move if key == "move" else rotate)(out.motion, values, what)
        words = words[1 + KEYWORDS[key]:]
    return out


# keyword -> number of values
KEYWORDS = {"side": 1, "units": 1, "move": 3, "rotate": 7, "open": 1}


def found(kernel, x: np.ndarray, *geometry) -> np.ndarray:
    """What a kernel of `asemd.kernels.inside` says of points (n, 3): (n,) bool."""
    out = np.empty(len(x), bool)
    kernel(np.ascontiguousarray(x.T, float), *geometry, out)
    return out


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
    value = number(word, what) * spacing
    if value < 0.0:
        raise InputError(f"{what}: radius must not be negative, got {word}")
    return value
