"""The simulation box: an origin, three vectors in the user's own frame, and what happens at each face."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asemd import tilted
from asemd.errors import InputError, SimulationError

BOUNDARIES = {"p": "periodic", "f": "fixed", "s": "shrink-wrapped", "m": "shrink-wrapped with a minimum"}
MARGIN = 1e-4      # LAMMPS keeps a shrink-wrapped face this part of the initial box length away from the outermost atom
FARTHEST = 1e9     # boxes; image flags are 32-bit numbers


def _boundary(words: Sequence[str]) -> tuple[str, str, str]:
    """Three two-letter boundaries; one letter stands for both faces."""
    if len(words) != 3:
        raise InputError(f"boundary needs three words, got {' '.join(words)}")
    out = []
    for word in words:
        pair = word * 2 if len(word) == 1 else word
        if len(pair) != 2 or not set(pair) <= set(BOUNDARIES):
            raise InputError(f"boundary {word!r} is not made of the letters p f s m")
        if "p" in pair and pair != "pp":
            raise InputError(f"boundary {word!r}: both faces of a dimension must be periodic, or none")
        out.append(pair)
    return tuple(out)


@dataclass
class Box:
    """Origin, cell vectors and boundaries of a system.

    Parameters
    ----------
    origin : (3,) array
        Corner of the box, distance units.
    cell : (3, 3) array
        Rows are the box vectors a, b, c; any orientation, handedness and tilt.
    boundary : three str
        Two letters for each of a, b, c (lower and upper face): p periodic, f fixed, s shrink-wrapped, m shrink-wrapped with a minimum.
    triclinic : bool, optional
        Whether LAMMPS would call it triclinic; by default True for everything but vectors along x, y, z.
    initial : (2, 3) array, optional
        Lower and upper bounds at the time the box was defined (LAMMPS's frame only): they set the margin of shrink-wrapped faces and the
        minimum of ``m``. By default the bounds given here.

    Raises
    ------
    InputError
        Numbers that are not finite, vectors without volume, unknown boundary letters.
    """

    origin: np.ndarray
    cell: np.ndarray
    boundary: tuple[str, str, str] = ("pp", "pp", "pp")
    triclinic: bool | None = None
    initial: np.ndarray | None = None

    def __post_init__(self):
        self.origin = np.array(self.origin, float).reshape(3)
        self.cell = np.array(self.cell, float).reshape(3, 3)
        self.boundary = _boundary(self.boundary)
        if not (np.isfinite(self.origin).all() and np.isfinite(self.cell).all()):
            raise InputError("the box has a bound that is NaN or infinite")
        if self.volume <= 1e-12 * np.prod(self.lengths):
            raise InputError("the box vectors span no volume")
        if self.triclinic is None:
            self.triclinic = not self.aligned
        if self.initial is None and self.is_lammps_frame:
            self.initial = np.array([self.lo, self.hi])

    @classmethod
    def from_lammps(cls, lo, hi, tilt=(0.0, 0.0, 0.0), boundary=("pp", "pp", "pp"), triclinic: bool = False) -> Box:
        """A box by LAMMPS's numbers: bounds `lo`, `hi` (3,) and tilt factors (xy, xz, yz), distance units."""
        lo, hi = np.array(lo, float), np.array(hi, float)
        for axis, a, b in zip("xyz", lo, hi):
            if not a < b:
                raise InputError(f"box bounds {axis}lo {a:g} and {axis}hi {b:g}: lo must be less than hi")
        xy, xz, yz = (float(t) for t in tilt)
        lx, ly, lz = hi - lo
        return cls(lo, [[lx, 0, 0], [xy, ly, 0], [xz, yz, lz]], boundary, triclinic or any((xy, xz, yz)), np.array([lo, hi]))

    @classmethod
    def from_ase(cls, cell, pbc, origin=(0.0, 0.0, 0.0), positions=None) -> Box:
        """A box by ASE's numbers; non-periodic directions without a vector are completed so that they hold all atoms.

        Parameters
        ----------
        cell : (3, 3) array
        pbc : (3,) bool
            Non-periodic directions become ``ss``: atoms never leave through them.
        origin : (3,) array
            ASE's celldisp.
        positions : (n, 3) array, optional
        """
        cell, pbc = np.array(cell, float), np.broadcast_to(np.asarray(pbc, bool), 3)
        origin = np.array(origin, float).reshape(3)
        missing = ~cell.any(axis=1)
        if (missing & pbc).any():
            raise InputError(f"cell vector {'abc'[int(np.argmax(missing & pbc))]} is zero but its direction is periodic")
        if missing.any():
            x = np.zeros((1, 3)) if positions is None or not len(positions) else np.asarray(positions, float)
            for k in np.flatnonzero(missing):
                direction = _orthogonal(cell, k)
                along = (x - origin) @ direction
                length = max(1.0, 1.001 * np.ptp(along))
                origin = origin + (along.min() + 0.5 * (np.ptp(along) - length)) * direction
                cell[k] = length * direction
        return cls(origin, cell, tuple("pp" if p else "ss" for p in pbc))

    def __eq__(self, other) -> bool:
        return (isinstance(other, Box) and np.array_equal(self.origin, other.origin) and np.array_equal(self.cell, other.cell)
                and self.boundary == other.boundary and self.triclinic == other.triclinic)

    __hash__ = None

    # ---- shape
    @property
    def periodic(self) -> np.ndarray:
        """(3,) bool."""
        return np.array([b == "pp" for b in self.boundary])

    @property
    def lengths(self) -> np.ndarray:
        """(3,) lengths of the box vectors."""
        return np.sqrt((self.cell**2).sum(axis=1))

    @property
    def volume(self) -> float:
        return abs(float(np.linalg.det(self.cell)))

    @property
    def inverse(self) -> np.ndarray:
        """(3, 3): ``(x - origin) @ inverse`` are fractional coordinates."""
        return tilted.inverse(self.cell) if self.is_lammps_frame else np.linalg.inv(self.cell)

    @property
    def aligned(self) -> bool:
        """True if a, b, c lie along +x, +y, +z."""
        c = self.cell
        return not (c[0, 1] or c[0, 2] or c[1, 0] or c[1, 2] or c[2, 0] or c[2, 1]) and c[0, 0] > 0 and c[1, 1] > 0 and c[2, 2] > 0

    @property
    def is_lammps_frame(self) -> bool:
        """True if a is along +x, b in the xy plane with positive y, c with positive z."""
        c = self.cell
        return not (c[0, 1] or c[0, 2] or c[1, 2]) and c[0, 0] > 0 and c[1, 1] > 0 and c[2, 2] > 0

    def _lammps_only(self, what: str) -> None:
        if not self.is_lammps_frame:
            raise InputError(f"the box has no {what}: its vectors are not in LAMMPS's frame (a along x, b in the xy plane)")

    @property
    def lo(self) -> np.ndarray:
        """(3,) xlo ylo zlo; only in LAMMPS's frame."""
        self._lammps_only("lo")
        return self.origin.copy()

    @property
    def hi(self) -> np.ndarray:
        """(3,) xhi yhi zhi; only in LAMMPS's frame."""
        self._lammps_only("hi")
        return self.origin + np.diag(self.cell)

    @property
    def tilt(self) -> np.ndarray:
        """(3,) xy xz yz; only in LAMMPS's frame."""
        self._lammps_only("tilt")
        return self.cell[[1, 2, 2], [0, 0, 1]]

    def fractional(self, x: np.ndarray) -> np.ndarray:
        """Fractional coordinates of positions (n, 3)."""
        d = x - self.origin
        if self.is_lammps_frame and self.triclinic:
            return tilted.fractional(d, self.cell)
        if self.aligned:
            return d / np.diag(self.cell)
        a, b, c = self.inverse      # by hand: the digits of a matrix product depend on how many rows there are
        return d[:, 0, None] * a + d[:, 1, None] * b + d[:, 2, None] * c

    # ---- periodicity
    def wrap(self, x: np.ndarray, image: np.ndarray) -> None:
        """Move atoms into the box along periodic directions, in place.

        Parameters
        ----------
        x : (n, 3) float
            Positions; end in [lo, hi), for boxes that are not aligned in terms of `fractional`.
        image : (n, 3) int32
            Image flags, changed so that `unwrap` gives the same positions as before.

        Raises
        ------
        SimulationError
            A position that is NaN or infinite, or more than 1e9 boxes away.
        """
        if not np.isfinite(x).all():
            row = int(np.argmin(np.isfinite(x).all(axis=1)))
            raise SimulationError(f"the position of atom row {row} is not finite: {x[row]}")
        if len(x) and self.periodic.any():
            far = np.abs(self.fractional(x)[:, self.periodic]).max(axis=1)
            if far.max() > FARTHEST:
                raise SimulationError(f"atom row {int(np.argmax(far))} is {far.max():.3g} boxes away, too far to be wrapped")
        (self._wrap_aligned if self.aligned else self._wrap_tilted if self.is_lammps_frame else self._wrap_general)(x, image)

    def remap(self, x: np.ndarray, image: np.ndarray) -> None:
        """`wrap` with LAMMPS's last bits for atoms of files: in tilted boxes all of them go through fractional coordinates and back."""
        before = image.copy()
        self.wrap(x, image)
        if (stayed := (image == before).all(axis=1) & self.triclinic & self.is_lammps_frame).any():
            x[stayed] = tilted.positions(self.fractional(x[stayed]), self.cell, self.origin)

    def _wrap_aligned(self, x, image):
        for k in np.flatnonzero(self.periodic):
            lo, length = self.origin[k], self.cell[k, k]
            hi = lo + length
            out = np.flatnonzero((x[:, k] < lo) | (x[:, k] >= hi))
            if not out.size:
                continue
            old = x[out, k]
            n = np.floor((old - lo) / length)
            n = np.where(old < lo, np.minimum(n, -1.0), np.maximum(n, 1.0))
            new = old - n * length
            for step, off in ((1.0, new >= hi), (-1.0, new < lo)):     # rounding next to a face
                new[off] -= step * length
                n[off] += step
            n[new >= hi] += 1.0        # neither here nor a period down: at the lower face
            new = np.where((new < lo) | (new >= hi), lo, new)
            x[out, k] = new
            image[out, k] += n.astype(image.dtype)

    def _wrap_tilted(self, x, image):
        """In fractional coordinates, as LAMMPS does it: what is next to the upper face by rounding comes to lie on the lower one."""
        s = self.fractional(x)
        n = np.where(self.periodic, np.floor(s), 0.0)
        rows = np.flatnonzero(n.any(axis=1))
        s, n = s[rows] - n[rows], n[rows]
        upper = self.periodic & (s >= 1.0)
        s, n = np.where(upper, s - 1.0, s), n + upper
        x[rows] = tilted.positions(s, self.cell, self.origin)
        image[rows] += n.astype(image.dtype)

    def _wrap_general(self, x, image):
        periodic = self.periodic
        if not periodic.any():
            return
        rows = np.arange(len(x))
        for _ in range(3):          # the second pass repairs the rounding of atoms far away
            s = self.fractional(x[rows])
            n = np.where(periodic, np.floor(s), 0.0)
            moved = n.any(axis=1)
            if not moved.any():
                return
            rows, n = rows[moved], n[moved]
            for k in range(3):
                x[rows] -= n[:, k, None] * self.cell[k]
            image[rows] += n.astype(image.dtype)
        push = np.finfo(float).eps   # what is left sits on a face within rounding: put it just inside
        while True:
            s = self.fractional(x[rows])
            off = periodic & ((s < 0.0) | (s >= 1.0))
            if not off.any():
                return
            x[rows] += np.where(off, np.where(s < 0.0, push - s, 1.0 - push - s), 0.0) @ self.cell
            push *= 2.0

    def unwrap(self, x: np.ndarray, image: np.ndarray) -> np.ndarray:
        """Positions (n, 3) outside the box, as the image flags say."""
        return x + image.astype(float) @ self.cell      # whole numbers would not go through BLAS

    def minimum_image(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The shortest periodic images of separations; exact for any tilt.

        Parameters
        ----------
        d : (n, 3)

        Returns
        -------
        (n, 3) float
            The shortest separations.
        (n, 3) int32
            Box vectors that were added: ``shortest = d + shift @ cell``.
        """
        d = np.asarray(d, float)
        periodic = self.periodic
        if not periodic.any() or not len(d):
            return d.copy(), np.zeros(d.shape, np.int32)
        if self.aligned:
            near, shift = d.copy(), np.zeros(d.shape, np.int32)
            for k in np.flatnonzero(periodic):
                length = self.cell[k, k]
                far = np.flatnonzero(np.abs(d[:, k]) > 0.499999 * length)
                n = -np.rint(d[far, k] / length)
                near[far, k] += n * length
                shift[far, k] = n
            return near, shift
        basis, steps = tilted.reduced(self.cell[periodic])
        n = -np.rint(d @ np.linalg.pinv(basis))
        near = d + n @ basis
        around = np.stack(np.meshgrid(*([-1, 0, 1],) * len(basis), indexing="ij"), -1).reshape(-1, len(basis))
        length = ((near[:, None] + around @ basis) ** 2).sum(axis=2)
        length[:, len(around) // 2] *= 1.0 - 1e-12    # a tie stays where it is
        best = around[np.argmin(length, axis=1)]
        n, near = n + best, near + best @ basis
        shift = np.zeros(d.shape, np.int32)
        shift[:, periodic] = n @ steps
        return near, shift

    # ---- other boxes
    def replicate(self, nx: int, ny: int, nz: int) -> Box:
        """The box with each vector multiplied."""
        return Box(self.origin, self.cell * np.array([[nx], [ny], [nz]]), self.boundary, self.triclinic)

    def shrink_wrapped(self, x: np.ndarray) -> Box:
        """The box with its shrink-wrapped faces moved to the atoms (LAMMPS's frame only; others come back as they are).

        A face ``s`` ends 1e-4 of the initial box length beyond the outermost atom; ``m`` does not go inside the initial bound.
        A vector that is tilted keeps its direction, and becomes longer or shorter.
        """
        if not self.is_lammps_frame or not len(x) or not any(set(b) & set("sm") for b in self.boundary):
            return self
        s = self.fractional(x)
        lo, hi = self.lo, self.hi
        length = hi - lo
        margin = MARGIN * (self.initial[1] - self.initial[0])
        new_lo, new_hi, tilt = lo.copy(), hi.copy(), list(self.tilt)
        for k, (lower, upper) in enumerate(self.boundary):
            if lower in "sm":
                new_lo[k] = lo[k] + s[:, k].min() * length[k] - margin[k]
            if lower == "m":
                new_lo[k] = min(new_lo[k], self.initial[0, k])
            if upper in "sm":
                new_hi[k] = lo[k] + s[:, k].max() * length[k] + margin[k]
            if upper == "m":
                new_hi[k] = max(new_hi[k], self.initial[1, k])
        for k in (1, 2):      # another direction would change what is inside the cell along the others
            moved, longer = (new_lo[k] - lo[k]) / length[k], (new_hi[k] - new_lo[k]) / length[k]
            if np.count_nonzero(self.cell[k]) > 1 and (moved, longer) != (0.0, 1.0):
                new_lo[:k] += moved * self.cell[k, :k]
                new_hi[:k] += moved * self.cell[k, :k]
                tilt[k - 1:2 * k - 1] = longer * self.cell[k, :k]
        box = Box.from_lammps(new_lo, new_hi, tilt, self.boundary, self.triclinic)
        box.initial = self.initial
        return box

    def widened(self) -> Box:
        """The box with every face ``s`` moved out by its margin: atoms on the face are inside."""
        margin = MARGIN * (self.hi - self.lo)
        lo = self.lo - margin * [b[0] == "s" for b in self.boundary]
        wide = Box.from_lammps(lo, self.hi + margin * [b[1] == "s" for b in self.boundary], self.tilt, self.boundary, self.triclinic)
        wide.initial = self.initial
        return wide

    def beyond(self, x: np.ndarray) -> np.ndarray:
        """(n, 3) bool: which atoms are beyond a fixed face along each cell vector."""
        s = self.fractional(x)
        lower, upper = (np.array([faces[k] == "f" for faces in self.boundary]) for k in (0, 1))
        return (s < 0.0) & lower | (s >= 1.0) & upper

    def to_lammps(self) -> tuple[Box, np.ndarray]:
        """The box in LAMMPS's frame, at the origin, and how to get there.

        Returns
        -------
        Box
            Lower-triangular, right-handed.
        (3, 3) array
            `rotation`: ``x_lammps = (x - origin) @ rotation`` for positions, ``v @ rotation`` for vectors, ``rotation.T @ t @ rotation``
            for tensors; its transpose leads back. A left-handed box is reflected (determinant -1).
        """
        if self.is_lammps_frame:
            rotation = np.eye(3)
            cell = self.cell
        else:
            q, r = np.linalg.qr(self.cell.T)
            sign = np.where(np.diag(r) < 0.0, -1.0, 1.0)
            rotation, cell = q * sign, np.tril((sign[:, None] * r).T)
        return Box(np.zeros(3), cell, self.boundary, bool(self.triclinic or np.tril(cell, -1).any())), rotation

    def turned(self) -> tuple[Box, np.ndarray]:
        """As `to_lammps`, but the origin stays: ``x_lammps = (x - origin) @ rotation + origin``. The box counts as triclinic."""
        box, rotation = self.to_lammps()
        return Box.from_lammps(self.origin, self.origin + np.diag(box.cell), box.tilt, self.boundary, triclinic=True), rotation


def _orthogonal(cell: np.ndarray, k: int) -> np.ndarray:
    """A unit vector orthogonal to the non-zero rows of `cell`; right-handed with them if that decides it, else along axis k."""
    have = cell[cell.any(axis=1)]
    if len(have) == 2:
        n = np.cross(cell[(k + 1) % 3], cell[(k + 2) % 3])
        return n / np.linalg.norm(n)
    q = np.linalg.qr(have.T)[0] if len(have) else np.zeros((3, 0))
    rest = np.eye(3) - (np.eye(3) @ q) @ q.T
    order = [k, (k + 1) % 3, (k + 2) % 3]
    best = max(order, key=lambda i: round(float(np.linalg.norm(rest[i])), 6))
    return rest[best] / np.linalg.norm(rest[best])
