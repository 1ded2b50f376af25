r"""Temperature after a profile of flow, measured in bins, has been taken off.

The bias of an atom is the velocity of the centre of mass of the atoms of the group in its bin, in the chosen directions. The degrees of
freedom are those of all atoms, less those of fixes, less one for each bin and chosen direction (D. J. Evans, G. P. Morriss, Phys. Rev.
Lett. 56, 2172 (1986)), less extra/dof, by default one for each direction that was not chosen. With ``out bin`` there is an array instead
of the tensor: atoms and temperature of each bin.

Source: LAMMPS manual, compute temp/profile. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._pieces import Pieces
from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest
from asemd.words import choice, take, whole

BINS = ("x", "y", "z", "xy", "yz", "xz", "xyz")


class TempProfile(Temp):
    """Temperature relative to a profile.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    directions : (bool, bool, bool)
        Components that have a bias.
    axes : str
        Along which there are bins: x, y, z, xy, yz, xz or xyz.
    bins : sequence of int
        How many along each of these.
    out : str
        ``tensor`` or ``bin``.

    Raises
    ------
    InputError
        No direction, z in two dimensions, no bin.
    """

    style = "temp/profile"
    columns = 2     # of the array
    bias = True

    def __init__(self, group: str = "all", directions=(True, True, True), axes: str = "xyz", bins=(1, 1, 1), out: str = "tensor"):
        super().__init__(group)
        self.directions, self.axes, self.bins, self.out = np.array(directions, bool), axes, tuple(bins), out
        if not self.directions.any():
            raise InputError("compute temp/profile: at least one of the flags must be 1")
        if min(self.bins) < 1:
            raise InputError(f"compute temp/profile: there must be at least 1 bin along each axis, got {' '.join(map(str, self.bins))}")

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute temp/profile"
        flags = [whole(w, what) for w in take(words, 3, f"{what} (xflag yflag zflag binstyle)")]
        axes = choice(take(words[3:], 1, f"{what} binstyle")[0], BINS, what)
        bins = [whole(w, what) for w in take(words[4:], len(axes), f"{what} {axes}")]
        out, words = "tensor", words[4 + len(axes):]
        while words:
            if words[0] != "out":
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], ['out'])}")
            out, words = choice(take(words[1:], 1, f"{what} out")[0], ("tensor", "bin"), f"{what} out"), words[2:]
        if any(f not in (0, 1) for f in flags):
            raise InputError(f"{what}: flags must be 0 or 1, got {' '.join(map(str, flags))}")
        if session.scene.dimension == 2 and (flags[2] or "z" in axes):
            raise InputError(f"{what}: a 2d simulation has no z direction")
        return cls(group, flags, axes, bins, out)

    def to_lammps(self) -> list[str]:
        return [*(str(int(d)) for d in self.directions), self.axes, *map(str, self.bins), *(["out", "bin"] if self.out == "bin" else [])]

    def _bin(self, system) -> np.ndarray:
        """(n,) the bin of each atom, from 0."""
        box, at = system.box, np.zeros(system.n, int)
        fractions = box.fractional(system.x)
        for axis, count in zip(self.axes, self.bins, strict=True):
            k = "xyz".index(axis)
            s = fractions[:, k] - np.floor(fractions[:, k]) if box.periodic[k] else fractions[:, k]
            at = at * count + np.clip((s * count).astype(int), 0, count - 1)
        return at

    def _pieces(self, state) -> tuple[np.ndarray, Pieces]:
        at = self._bin(state.system)
        return at, Pieces(state.system, np.where(state.mask(self.group), at + 1, 0), int(np.prod(self.bins)))

    def dof(self, state) -> float:
        return max(self._loose(state) - np.count_nonzero(self.directions) * int(np.prod(self.bins)), 0.0)

    def _loose(self, state) -> float:
        """Degrees of freedom before the bins take theirs."""
        held = self.extra_dof
        try:
            self.extra_dof = state.system.dimension - np.count_nonzero(self.directions) if held is None else held
            return super().dof(state)
        finally:
            self.extra_dof = held

    def remove_bias(self, state) -> np.ndarray:
        at, bins = self._pieces(state)
        return state.system.v - np.where(self.directions, bins.vcm, 0.0)[at]

    def vector(self, state) -> np.ndarray:
        if self.out == "bin":
            raise InputError(f"compute {self.id} (temp/profile with out bin) has no global vector")
        return super().vector(state)

    def array_columns(self) -> int | None:
        return 2 if self.out == "bin" else None

    def array(self, state) -> np.ndarray:
        """(bins, 2) atoms and temperature of each bin."""
        if self.out != "bin":
            raise InputError(f"compute {self.id} (temp/profile without out bin) has no global array")
        at, bins = self._pieces(state)
        v = self.remove_bias(state)[bins.rows]
        twice = bins.sum(bins.m * (v * v).sum(axis=1))
        share = self._loose(state) / max(len(bins.rows), 1)
        dof = share * bins.atoms - np.count_nonzero(self.directions)
        t = np.divide(twice, dof, out=np.zeros(len(twice)), where=dof > 0) * (state.units.mvv2e / state.units.boltz)
        return np.column_stack([bins.atoms, t])
