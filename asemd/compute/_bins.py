"""Bins of compute chunk/atom: layers along axes, spherical shells, cylindrical shells with layers."""
from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from asemd.errors import InputError
from asemd.kernels import observe

DISCARD = ("yes", "no", "mixed")


class Frame:
    """The box as bins see it: its own lengths, or from 0 to 1 for ``units reduced``; spheres and cylinders are round in both."""

    def __init__(self, system, reduced: bool):
        box = system.box
        self.system, self.periodic, self.reduced, self.cell = system, box.periodic, reduced, box.cell
        lo, hi = np.asarray(box.lo), np.asarray(box.hi)
        self.lo, self.hi = (np.zeros(3), np.ones(3)) if reduced else (lo, hi)
        self.length = self.hi - self.lo

    @cached_property
    def x(self) -> np.ndarray:
        """(n, 3) of the atoms, within the periodic directions of the box."""
        x = self.system.x.copy(order="F")        # columns in one piece
        if self.reduced:
            x = self.system.box.fractional(x)
        for k in np.flatnonzero(self.periodic):
            c = x[:, k]
            c += np.where(c < self.lo[k], self.length[k], 0.0)
            c -= np.where(c >= self.hi[k], self.length[k], 0.0)
        return x

    @cached_property
    def real(self) -> Frame:
        """The box as it is."""
        return Frame(self.system, False) if self.reduced else self

    def point(self, c: np.ndarray, axes: list[int]) -> np.ndarray:
        """Coordinates along some axes as distance units."""
        if not self.reduced:
            return c
        full = np.zeros(3)
        full[axes] = c
        return (self.real.lo + full @ self.cell)[axes]

    def radius(self, r: float, axis: int) -> float:
        """A radius, which scales with the length of the box along an axis."""
        return r * self.real.length[axis] if self.reduced else r

    def place(self, where: str | float, k: int) -> float:
        """A coordinate: ``lower``, ``upper`` or a number."""
        named = {"lower": self.lo[k], "upper": self.hi[k]}
        return float(named[where]) if isinstance(where, str) else where


class Layers:
    """Layers along one axis.

    Parameters
    ----------
    axis : int
    origin : str or float
        Where a layer begins: a coordinate, or the lower or upper bound of the bins or the ``center`` between them.
    delta : float
        Thickness.
    """

    def __init__(self, axis: int, origin: str | float, delta: float):
        self.axis, self.origin, self.delta = axis, origin, delta

    def fit(self, frame: Frame, bound: tuple[str | float, str | float]) -> tuple[float, int]:
        """Where the first layer begins, and how many there are between the bounds."""
        k, delta = self.axis, self.delta
        least, most = frame.place(bound[0], k), frame.place(bound[1], k)
        named = {"lower": least, "center": 0.5 * (least + most), "upper": most}
        origin = named[self.origin] if isinstance(self.origin, str) else self.origin
        if origin < least:
            lo = origin + int((least - origin) / delta) * delta
        else:
            lo = origin - int((origin - least) / delta) * delta
            if lo > least:
                lo -= delta
        if origin < most:
            hi = origin + int((most - origin) / delta) * delta
            if hi < most:
                hi += delta
        else:
            hi = origin - int((origin - most) / delta) * delta
        if lo > hi:
            raise InputError(f"compute chunk/atom: the bounds of the bins along {'xyz'[k]} are the wrong way round")
        return lo, int((hi - lo) / delta + 0.5)

    def assign(self, frame: Frame, bound, discard: str) -> tuple[np.ndarray, np.ndarray, int]:
        """(n,) layer of each atom from 0, (n,) whether it has one, and how many layers there are."""
        return numbers([self], frame, [bound], discard)

    def middles(self, frame: Frame, bound) -> np.ndarray:
        lo, count = self.fit(frame, bound)
        return lo + (np.arange(count) + 0.5) * self.delta


def numbers(layers: list[Layers], frame: Frame, bounds: list, discard: str) -> tuple[np.ndarray, np.ndarray, int]:
    """(n,) bin of each atom in layers along several axes, the last one varies fastest; (n,) whether it has one; how many there are."""
    found = [layer.fit(frame, bound) for layer, bound in zip(layers, bounds)]
    counts = np.array([count for _, count in found])
    keep = np.array([[discard == "no" or discard == "mixed" and not isinstance(b, float) for b in bound] for bound in bounds])
    system, box = frame.system, frame.system.box
    aligned = not (frame.reduced and box.triclinic)
    x, edges = system.x if aligned else box.fractional(system.x), np.diag(box.cell).copy()
    at, known = np.empty(len(x), np.int64), np.empty(len(x), bool)
    observe.grid(x, box.origin, edges, frame.reduced and aligned, np.asarray(frame.periodic), frame.lo, frame.hi,
                 np.array([layer.axis for layer in layers]), np.array([first for first, _ in found], float),
                 np.array([layer.delta for layer in layers], float), counts, keep, at, known)
    return at, known, int(np.prod(counts))


class Grid:
    """Bins in one, two or three directions; the last one varies fastest."""

    def __init__(self, layers: list[Layers]):
        self.layers, self.directions = layers, len(layers)

    def assign(self, frame: Frame, bounds, discard: str, pbc: bool) -> tuple[np.ndarray, np.ndarray, int]:
        return numbers(self.layers, frame, [bounds[layer.axis] for layer in self.layers], discard)

    def middles(self, frame: Frame, bounds) -> np.ndarray:
        """(bins, directions)."""
        axes = [layer.middles(frame, bounds[layer.axis]) for layer in self.layers]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def shells(r: np.ndarray, least: float, most: float, count: int, discard: str) -> tuple[np.ndarray, np.ndarray]:
    """The shell of each distance, and whether it has one."""
    at = np.floor((r - least) * (count / (most - least))).astype(int)
    known = np.ones(len(r), bool) if discard != "yes" else (at >= 0) & (at < count)
    return np.clip(at, 0, count - 1), known


def away(frame: Frame, axes: list[int], origin: np.ndarray, pbc: bool) -> np.ndarray:
    """(n, len(axes)) from the origin to the atoms, distance units; to closest images if `pbc`."""
    origin, frame = frame.point(origin, axes), frame.real
    d = frame.x[:, axes] - origin
    for column, k in enumerate(axes):
        if pbc and frame.periodic[k]:
            d[:, column] -= frame.length[k] * np.round(d[:, column] / frame.length[k])
    return d


class Sphere:
    """Spherical shells."""

    directions = 1

    def __init__(self, origin, least: float, most: float, count: int):
        self.origin, self.least, self.most, self.count = np.array(origin, float), least, most, count

    def assign(self, frame, bounds, discard, pbc):
        radius, box = self._ends(frame)[1], frame.real
        for k in np.flatnonzero(box.periodic & pbc & (2.0 * radius > box.length)):
            raise InputError(f"compute chunk/atom bin/sphere: with pbc yes rmax {radius:g} must not be above half the box along {'xyz'[k]}")
        d = away(frame, [0, 1, 2], self.origin, pbc)
        at, known = shells(np.sqrt((d * d).sum(axis=1)), *self._ends(frame), self.count, discard)
        return at, known, self.count

    def _ends(self, frame) -> tuple[float, float]:
        return frame.radius(self.least, 0), frame.radius(self.most, 0)

    def middles(self, frame, bounds) -> np.ndarray:
        """(bins, 1) radii."""
        least, most = self._ends(frame)
        return (least + (np.arange(self.count) + 0.5) * (most - least) / self.count)[:, None]


class Cylinder:
    """Cylindrical shells, each with layers along the axis."""

    directions = 2

    def __init__(self, layers: Layers, origin, least: float, most: float, count: int):
        self.layers, self.origin, self.least, self.most, self.count = layers, np.array(origin, float), least, most, count
        self.axes = [k for k in range(3) if k != layers.axis]

    def assign(self, frame, bounds, discard, pbc):
        k, inside, count = self.layers.assign(frame, bounds[self.layers.axis], discard)
        d = away(frame, self.axes, self.origin, pbc)
        at, known = shells(np.hypot(d[:, 0], d[:, 1]), *self._ends(frame), self.count, discard)
        return at * count + k, inside & known, self.count * count

    def _ends(self, frame) -> tuple[float, float]:
        return frame.radius(self.least, self.axes[0]), frame.radius(self.most, self.axes[0])

    def middles(self, frame, bounds) -> np.ndarray:
        """(bins, 2) radius and position along the axis."""
        least, most = self._ends(frame)
        r = least + (np.arange(self.count) + 0.5) * (most - least) / self.count
        return np.stack(np.meshgrid(r, self.layers.middles(frame, bounds[self.layers.axis]), indexing="ij"), axis=-1).reshape(-1, 2)


def positive(value: float, what: str) -> float:
    """A length of bins."""
    if not (value > 0.0 and math.isfinite(value)):
        raise InputError(f"{what}: bins must be thicker than 0, got {value:g}")
    return value
