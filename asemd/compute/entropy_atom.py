r"""Entropy of each atom by the distances of its neighbours, in units of Boltzmann's constant.

.. math:: s_i = -2\pi\rho \int_0^{r_c} \left[ g_i \ln g_i - g_i + 1 \right] r^2 \, dr, \qquad
   g_i(r) = \frac{1}{4\pi\rho r^2} \sum_j \frac{1}{\sqrt{2\pi\sigma^2}} e^{-(r - r_{ij})^2 / (2\sigma^2)}

on points that are :math:`\sigma` apart. Source: LAMMPS manual, compute entropy/atom; Piaggi and Parrinello, J. Chem. Phys. 147, 114112
(2017).
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half
from asemd.errors import InputError, nearest
from asemd.kernels import order
from asemd.words import number, take, yes_no


class EntropyAtom(Compute):
    """Entropy by the pair distribution.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    sigma : float
        Width of the Gaussians, distance units.
    cutoff : float
        The end of the integral, distance units.
    average : float, optional
        Mean over the atom and its neighbours closer than this.
    local : bool
        The density is that of the atoms in the neighbour list of the atom (cutoff of the pair style plus skin), which stays until
        the list of the pair style is built again, not that of the box.

    Raises
    ------
    InputError
        Lengths that are not positive.
    """

    style = "entropy/atom"

    def __init__(self, group: str = "all", sigma: float = 0.25, cutoff: float = 5.0, average: float | None = None, local: bool = False):
        super().__init__(group)
        for name, value in (("sigma", sigma), ("cutoff", cutoff), ("avg cutoff", 1.0 if average is None else average)):
            if value <= 0.0:
                raise InputError(f"compute entropy/atom: {name} must be positive, got {value:g}")
        self.sigma, self.cutoff, self.average, self.near = sigma, cutoff, average, local
        self._counted: tuple = (None, 0, None)

    def __getstate__(self):
        return {**self.__dict__, "_counted": (None, 0, None)}

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute entropy/atom"
        sigma, cutoff = (number(w, what) for w in take(words, 2, what))
        rest, given = list(words[2:]), {}
        while rest:
            word = rest.pop(0)
            if word not in ("avg", "local"):
                raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, ('avg', 'local'))}")
            on = yes_no(take(rest, 1, f"{what} {word}")[0], f"{what} {word}")
            rest.pop(0)
            if word == "local":
                given["local"] = on
            else:
                length = number(take(rest, 1, f"{what} avg")[0], f"{what} avg cutoff")
                rest.pop(0)
                given["average"] = length if on else None
        return cls(group, sigma, cutoff, **given)

    def to_lammps(self) -> list[str]:
        average = ["avg", "yes", repr(self.average)] if self.average is not None else []
        return [repr(self.sigma), repr(self.cutoff), *average, *["local", "yes"] * self.near]

    def per_atom(self, state) -> np.ndarray:
        """(n,); zero outside the group."""
        system, mask = state.system, state.mask(self.group)
        reach = max(self.cutoff, self.average or 0.0)
        listed = force_cutoff(state, "compute entropy/atom") + state.engine.settings.skin
        start, other, _, square = half(state, reach, own=reach > listed).around(system.n)
        density = np.full(system.n, system.n / system.box.volume)
        if self.near:
            density = self._listed(state, listed) / (4.0 / 3.0 * np.pi * listed**3)
        atoms = np.arange(system.n) if self.average else np.flatnonzero(mask)
        out = np.zeros(system.n)
        order.entropies(atoms, start, square, self.sigma, self.cutoff, density, out)
        if self.average is not None:
            close = square < self.average**2
            count = np.bincount(np.repeat(np.arange(system.n), np.diff(start))[close], minlength=system.n)
            total = np.bincount(np.repeat(np.arange(system.n), np.diff(start))[close], out[other[close]], minlength=system.n)
            out = (out + total) / (1.0 + count)
        return np.where(mask, out, 0.0)

    def setup(self, state) -> None:
        """A run begins with a new list."""
        self._counted = (None, 0, None)

    def _listed(self, state, reach: float) -> np.ndarray:
        """(n,) how many atoms each has in its neighbour list: LAMMPS makes that on the first evaluation after the list of the pair style
        was built, and keeps it until that is built again."""
        engine = state.engine
        if self._counted[:2] != (engine, engine.builds):
            pairs = half(state, reach)
            self._counted = engine, engine.builds, np.bincount(np.append(pairs.i, pairs.j), minlength=state.system.n)
        return self._counted[2]
