r"""Lattices: a unit cell with basis atoms, scaled, rotated and shifted into the box; their spacings are a unit of length elsewhere."""
from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError, nearest

_SQUARE = ((0.0, 0.0, 0.0),), ((0.0, 0.0, 0.0), (0.5, 0.5, 0.0))
BASIS = {
    "sc": _SQUARE[0],
    "bcc": ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)),
    "fcc": ((0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5)),
    "hcp": ((0.0, 0.0, 0.0), (0.5, 0.5, 0.0), (0.5, 5.0 / 6.0, 0.5), (0.0, 1.0 / 3.0, 0.5)),
    "diamond": ((0.0, 0.0, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5), (0.5, 0.5, 0.0),
                (0.25, 0.25, 0.25), (0.25, 0.75, 0.75), (0.75, 0.25, 0.75), (0.75, 0.75, 0.25)),
    "sq": _SQUARE[0],
    "sq2": _SQUARE[1],
    "hex": _SQUARE[1],
}
MOST = 10**11      # lattice points that can be looked at in a bearable time
DIMENSION = {"sc": 3, "bcc": 3, "fcc": 3, "hcp": 3, "diamond": 3, "sq": 2, "sq2": 2, "hex": 2}
EDGES = {"hex": (1.0, math.sqrt(3.0), 1.0), "hcp": (1.0, math.sqrt(3.0), math.sqrt(8.0 / 3.0))}


@dataclass
class Lattice:
    """A lattice.

    Parameters
    ----------
    style : str
        ``none sc bcc fcc hcp diamond sq sq2 hex custom``.
    scale : float
        Lattice constant (distance units), or the reduced density if `density` is set.
    density : bool
        True for units lj.
    dimension : int
        2 or 3.
    origin : (3,) sequence
        Shift, fractions of the spacings, 0 <= origin < 1.
    orient : (3, 3) sequence of int
        Lattice directions along x, y, z of the box.
    spacing : (3,) sequence, optional
        Spacings in units of the lattice constant instead of the computed ones.
    vectors : (3, 3) sequence, optional
        Edge vectors a1, a2, a3 of style custom (rows).
    basis : (m, 3) sequence, optional
        Fractional positions of style custom.
    general : bool
        As ``triclinic/general``: the edge vectors of style custom are those of a general triclinic box.

    Attributes
    ----------
    spacings : (3,) float array
        Extent of the rotated unit cell along x, y, z: the unit "lattice" of other commands.

    Raises
    ------
    InputError
        Any argument out of range, orient vectors that are not orthogonal and right-handed, a flat cell.
    """

    style: str = "none"
    scale: float = 1.0
    density: bool = False
    dimension: int = 3
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orient: tuple[tuple[int, int, int], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    spacing: tuple[float, float, float] | None = None
    vectors: tuple[tuple[float, float, float], ...] | None = None
    basis: tuple[tuple[float, float, float], ...] = ()
    general: bool = False
    spacings: np.ndarray = field(init=False)

    def __post_init__(self):
        styles = ("none", "custom", *BASIS)
        if self.style not in styles:
            raise InputError(f"lattice: unknown style {self.style!r}{nearest(self.style, styles)}")
        if DIMENSION.get(self.style, self.dimension) != self.dimension:
            raise InputError(f"lattice {self.style} is for a {DIMENSION[self.style]}d simulation, this one is {self.dimension}d")
        if not (math.isfinite(self.scale) and self.scale > 0.0):
            raise InputError(f"lattice {self.style}: scale must be positive, got {self.scale:g}")
        if self.style == "none":
            self.spacings = np.full(3, float(self.scale))
            return
        if self.style != "custom":
            self.basis = BASIS[self.style]
            self.vectors = tuple(map(tuple, np.diag(EDGES.get(self.style, (1.0, 1.0, 1.0)))))
        self.basis = np.array(self.basis, dtype=float).reshape(-1, 3)
        edges = np.array(np.eye(3) if self.vectors is None else self.vectors, dtype=float)
        self._check(edges)
        self.primitive = edges.T
        rows = np.array(self.orient, dtype=float)
        self.rotation = rows / np.sqrt((rows * rows).sum(axis=1))[:, None]
        self.factor = float(self.scale)
        if self.density:
            volume = float(abs(np.dot(edges[0], np.cross(edges[1], edges[2]))))
            self.factor = math.pow(len(self.basis) / volume / self.scale, 1.0 / self.dimension)
        corners = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
        self.spacings = np.zeros(3)     # the origin does not shift the cell yet
        if self.spacing is not None:
            self.spacings = np.array(self.spacing, dtype=float) * self.factor
        else:
            self.spacings = np.ptp(self.to_box(corners) @ (self.turn() if self.general else np.eye(3)), axis=0)

    def _check(self, edges: np.ndarray) -> None:
        if not len(self.basis):
            raise InputError(f"lattice {self.style}: no basis atoms, give at least one with the keyword basis")
        if np.any(self.basis < 0.0) or np.any(self.basis >= 1.0):
            raise InputError(f"lattice {self.style}: basis coordinates must be at least 0 and below 1")
        if self.dimension == 2 and np.any(self.basis[:, 2] != 0.0):
            raise InputError(f"lattice {self.style}: basis atoms of a 2d lattice must have z = 0")
        if any(not 0.0 <= o < 1.0 for o in self.origin):
            raise InputError(f"lattice {self.style}: origin must be at least 0 and below 1 in every direction")
        if self.dimension == 2 and self.origin[2] != 0.0:
            raise InputError(f"lattice {self.style}: origin of a 2d lattice must have z = 0")
        x, y, z = np.array(self.orient)
        if x @ y or y @ z or x @ z:
            raise InputError(f"lattice {self.style}: the three orient vectors must be orthogonal to each other, give all three")
        if not (x.any() and y.any() and z.any()) or np.cross(x, y) @ z <= 0:
            raise InputError(f"lattice {self.style}: the orient vectors must be right-handed: x cross y must point along z")
        if self.dimension == 2 and (self.orient[2][0] or self.orient[2][1]):
            raise InputError(f"lattice {self.style}: a 2d lattice cannot be turned out of the plane, orient z must be 0 0 1")
        if self.spacing is not None and any(not (math.isfinite(s) and s > 0.0) for s in self.spacing):
            raise InputError(f"lattice {self.style}: spacings must be positive")
        if np.dot(edges[0], np.cross(edges[1], edges[2])) == 0.0:
            raise InputError(f"lattice {self.style}: the vectors a1, a2, a3 lie in one plane")
        if self.general and (self.style != "custom" or self.orient != Lattice.orient or any(self.origin)):
            raise InputError("lattice triclinic/general needs style custom, the default orientation and the default origin")
        if self.general and np.dot(edges[0], np.cross(edges[1], edges[2])) < 0.0:
            raise InputError("lattice triclinic/general: a1, a2, a3 must be right-handed")
        if self.general and self.dimension == 2 and tuple(edges[2]) != (0.0, 0.0, 1.0):
            raise InputError("lattice triclinic/general: a3 of a 2d lattice must be 0 0 1")
        if self.dimension == 2 and (edges[0, 2] or edges[1, 2] or edges[2, 0] or edges[2, 1]):
            raise InputError(f"lattice {self.style}: in 2d a1 and a2 must lie in the plane and a3 along z")

    def turn(self) -> np.ndarray:
        """(3, 3): ``x @ turn`` leads from the frame of the edge vectors into the one with a1 along x and a2 in the xy plane."""
        q, r = np.linalg.qr(self.primitive)
        return q * np.where(np.diag(r) < 0.0, -1.0, 1.0)

    def to_box(self, cells: np.ndarray) -> np.ndarray:
        """Positions in the box of points given in unit cells, (n, 3) -> (n, 3)."""
        p, r = self.primitive, self.rotation
        a, b, c = np.asarray(cells, dtype=float).T
        # sums in a fixed order: coordinates are compared by their last bit
        x, y, z = ((p[i, 0] * a + p[i, 1] * b + p[i, 2] * c) * self.factor for i in range(3))
        return np.column_stack([r[i, 0] * x + r[i, 1] * y + r[i, 2] * z + self.spacings[i] * self.origin[i] for i in range(3)])

    def from_box(self, x: np.ndarray) -> np.ndarray:
        """The inverse of `to_box`."""
        shifted = (np.asarray(x, dtype=float) - self.spacings * np.array(self.origin)) @ self.rotation
        return shifted @ np.linalg.inv(self.primitive).T / self.factor

    def points(self, lo: np.ndarray, hi: np.ndarray):
        """Lattice points near the box from `lo` to `hi` in LAMMPS's order, in portions.

        The third cell index runs slowest, the first fastest, basis atoms fastest of all.

        Yields
        ------
        x : (m, 3) float array
        basis : (m,) int array
            Number of the basis atom, from 0.
        """
        if self.style == "none":
            raise InputError("create_atoms: no lattice is defined, use the lattice command with a style other than none")
        corners = np.array([(x, y, z) for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])])
        cells = self.from_box(corners)
        first, last = np.floor(cells.min(axis=0)).astype(int) - 1, np.ceil(cells.max(axis=0)).astype(int) + 1
        if self.dimension == 2:     # one plane of cells
            first[2] = last[2] = 0
        ni, nj, nk = (last - first + 1).tolist()
        nb = len(self.basis)
        if ni * nj * nk * nb > MOST:
            raise InputError(f"create_atoms: the lattice has about {ni * nj * nk * nb:.2g} points in the box, which is too many; "
                             "are the lattice constant and the box in the units of the scene?")
        portion = max(1, 500_000 // int(ni * nj * nb))
        plane = np.empty((nj, ni, nb, 3))
        plane[..., 0] = np.arange(first[0], last[0] + 1)[None, :, None] + self.basis[:, 0]
        plane[..., 1] = np.arange(first[1], last[1] + 1)[:, None, None] + self.basis[:, 1]
        for k in range(first[2], last[2] + 1, portion):
            ks = np.arange(k, min(k + portion, last[2] + 1))
            block = np.broadcast_to(plane, (len(ks), *plane.shape)).copy()
            block[..., 2] = ks[:, None, None, None] + self.basis[:, 2]
            yield self.to_box(block.reshape(-1, 3)), np.tile(np.arange(nb), len(ks) * ni * nj)

    def text(self) -> str:
        return "Lattice spacing in x,y,z = " + " ".join(f"{s:.8g}" for s in self.spacings)
