"""What fixes of rigid bodies show of them: energies, degrees of freedom, the table of bodies, virials by atom."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix import rigid_bodies as rb


class BodyOutputs(Fix):
    """Outputs of `asemd.fix.rigid.Rigid`."""

    kept: rb.Bodies | None = None       # the bodies, from the first run on
    _warn = None
    _loop = None

    @property
    def bodies(self) -> rb.Bodies:
        """The bodies now, in the box as it is now."""
        if self.kept is None:
            raise InputError(f"fix {self.id} (style {self.style}): its bodies are not known before the first run: use run 0")
        if self.p[2] != 0.0:
            rb.follow(self.kept, self._loop.state.box.origin, self._loop.state.box.vectors)
        return self.kept

    def removed_dof(self, mask: np.ndarray) -> float:
        """Of bodies all of whose atoms are in `mask`."""
        b = self.kept
        if b is None:
            if self._warn is not None and b"" not in self.warned:
                self._warn("Cannot count rigid body degrees-of-freedom before bodies are initialized")
                self.warned.add(b"")
            return 0.0
        inside, size = np.add.reduceat(mask[b.rows].astype(np.int64), b.first[:-1]), np.diff(b.first)
        key = np.packbits(mask).tobytes()
        if ((inside > 0) & (inside != size)).any() and key not in self.warned:
            self.warned.add(key)
            self._warn("Computing temperature of portions of rigid bodies")
        finite = np.add.reduceat(rb.finite(b).astype(np.int64), b.first[:-1])      # their rotation, too
        if int(self.p[11]) == 2:
            return float((2 * size + finite - 3)[inside == size].sum())
        return float((3 * (size + finite) - 6 + (b.moments == 0.0).any(axis=1))[inside == size].sum())

    def bodies_energies(self) -> tuple[np.ndarray, np.ndarray]:
        """Energy of translation and of rotation of each body, in energy units, without components that do not act."""
        b = self.bodies
        w = np.einsum("nka,na->nk", b.axes, b.omega)
        return (0.5 * self.p[12] * b.mass * (b.moves[:, :3] * b.v**2).sum(axis=1),
                0.5 * self.p[12] * (b.moves[:, 3:] * b.moments * w**2).sum(axis=1))

    def scalar(self) -> float:
        """Temperature of the bodies."""
        b = self.bodies
        dof = b.moves.sum() - (np.count_nonzero((b.moments == 0.0).any(axis=1)) if self.p[11] == 3.0 else 0)
        return float(2.0 * sum(e.sum() for e in self.bodies_energies()) / (dof * self._loop.units.boltz)) if dof > 0.0 else 0.0

    def array(self, i: int, j: int) -> float:
        """Number `j` (1 to 15) of body `i`, counted from 1."""
        if self.small:
            raise InputError(f"fix {self.id} (style {self.style}) has no global array; fix {self.style.removesuffix('/small')} has")
        b = self.bodies
        if not 1 <= i <= len(b.mass) or not 1 <= j <= 15:
            raise InputError(f"fix {self.id} (style {self.style}) has {len(b.mass)} rows of 15 numbers, there is no [{i}][{j}]")
        return float((b.x, b.v, b.force, b.torque, b.image)[(j - 1) // 3][i - 1, (j - 1) % 3])

    def virials(self, state) -> np.ndarray:
        """(n, 6) each atom's virial of the constraint, xx yy zz xy xz yz, energy units."""
        out = np.zeros((state.system.n, 6))
        out[self.kept.rows] = self.kept.virial
        return out
