r"""A crystal that grows: layers of lattice atoms are put on top of the box, ahead of a shock that comes from below.

On multiples of N the lattice points from the upper face of the box along z to ``size`` above it get atoms at rest. The topmost ``size`` of
the box is frozen, so that nothing overlaps when more is put there: velocities and forces of all atoms in it are zero. With ``temp`` atoms
up to ``extent`` below the face (but not frozen) feel a Langevin thermostat,

$$F \leftarrow F - \frac{m}{\tau} v + \sqrt{\frac{24 k_B T m}{\tau \Delta t}}\, u, \quad u \in [-\tfrac12, \tfrac12)$$

Source: LAMMPS manual, fix append/atoms. Units: distance, temperature, time; with ``units lattice``, the default of scripts, ``size`` and
``random`` count in lattice spacings, ``extent`` does not. Random displacements are LAMMPS's; thermal noise equals it in distribution.
"""
from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from asemd import population
from asemd.errors import InputError, nearest
from asemd.fix import NEVER, Fix, hook
from asemd.kernels.random import uniform
from asemd.marsaglia import Marsaglia
from asemd.words import choice, number, take, whole

VALUES = {"basis": 2, "size": 1, "freq": 1, "temp": 4, "random": 4, "units": 1}


class AppendAtoms(Fix):
    """Put lattice atoms on top.

    Parameters
    ----------
    group : str
        Any; all atoms near the upper face are frozen.
    lattice : asemd.lattice.Lattice
        Whose points get atoms.
    size : float
        Height of what is added, and of what is frozen, distance units.
    every : int
        Steps between two additions.
    types : mapping of int to int
        Number of a basis atom, from 1 -> its atom type, if not 1.
    thermostat : (float, float, int, float), optional
        Temperature, damping time, seed, and how far below the upper face it acts, distance units.
    spread : (float, float, float, int), optional
        Largest displacements of new atoms along x, y, z, distance units, and a seed.

    Raises
    ------
    InputError
        Numbers that make no sense, no lattice.
    """

    style = "append/atoms"

    def __init__(self, group: str = "all", lattice=None, size: float = 0.0, every: int = 1, types: Mapping[int, int] | None = None,
                 thermostat: Sequence[float] | None = None, spread: Sequence[float] | None = None):
        super().__init__(group)
        if lattice is None or lattice.style == "none":
            raise InputError("fix append/atoms needs a lattice: use the lattice command with a style other than none")
        if every < 1:
            raise InputError(f"fix append/atoms freq: needs a number of steps of at least 1, got {every}")
        if size < 0.0:
            raise InputError(f"fix append/atoms size: must not be negative, got {size:g}")
        self.lattice, self.size, self.interval, self.types = lattice, size, every, dict(types or {})
        self.thermostat, self.spread, self.words = thermostat, spread, []
        for basis, kind in self.types.items():
            if not 1 <= basis <= len(lattice.basis) or kind < 1:
                raise InputError(f"fix append/atoms basis: the lattice has {len(lattice.basis)} basis atoms and types count from 1, "
                                 f"got {basis} {kind}")
        if thermostat is not None:
            target, damping, seed, extent = thermostat
            if not (target > 0.0 and damping > 0.0 and extent > 0.0):
                raise InputError(f"fix append/atoms temp: target, damp and extent must be above 0, got {target:g} {damping:g} {extent:g}")
            _check_seed(seed, "temp")
        if spread is not None:
            _check_seed(spread[3], "random")
            self.random = Marsaglia(int(spread[3]))

    @classmethod
    def from_lammps(cls, group, words, session):
        face, what = take(words, 1, "fix append/atoms face")[0], "fix append/atoms"
        if face != "zhi":
            raise InputError(f"{what}: Only zhi currently implemented for fix append/atoms, got {face!r}")
        scene = session.scene
        system = scene.need_system(what)
        if system.box.boundary[2][1] != "m":
            raise InputError(f"{what}: Append boundary must be shrink/minimum, use boundary ... m or sm along z")
        if system.box.triclinic or not system.box.is_lammps_frame:
            raise InputError(f"{what}: needs a box along the axes, not a tilted one")
        given: dict[str, list[str]] = {}
        types: dict[int, int] = {}
        rest = words[1:]
        while rest:
            key = rest[0]
            if key not in VALUES:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, VALUES)}")
            values, rest = take(rest[1:], VALUES[key], f"{what} {key}"), rest[1 + VALUES[key]:]
            if key == "basis":
                basis, kind = (whole(w, f"{what} basis") for w in values)
                if not 1 <= kind <= system.counts["ntypes"]:
                    raise InputError(f"{what} basis: atom type {kind} is outside the valid range 1 to {system.counts['ntypes']}")
                types[basis] = kind
            given[key] = values
        lattice = choice(given.get("units", ["lattice"])[0], ("lattice", "box"), f"{what} units") == "lattice"
        scale = scene.lattice.spacings if lattice and scene.lattice is not None else np.ones(3)
        size = number(given.get("size", ["0"])[0], f"{what} size") * scale[2]
        thermostat = spread = None
        if "temp" in given:
            a, b, c, d = given["temp"]
            thermostat = (number(a, f"{what} temp"), number(b, f"{what} temp"), whole(c, f"{what} temp seed"), number(d, f"{what} temp"))
        if "random" in given:
            moves = [number(w, f"{what} random") * s for w, s in zip(given["random"], scale)]
            spread = (*moves, whole(given["random"][3], f"{what} random seed"))
        fix = cls(group, scene.lattice, float(size), whole(given.get("freq", ["0"])[0], f"{what} freq"), types, thermostat, spread)
        fix.words = list(words)
        return fix

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError("fix append/atoms: this one was made in Python and has no script form")
        return self.words

    def parameters(self, loop) -> np.ndarray:
        p = np.array([float(loop.group_bit(self.group)), self.size, 0.0, 0.0, 0.0, 0.0])
        if self.thermostat is not None:
            target, damping, seed, extent = self.thermostat
            u = loop.units
            p[2:] = (extent, 1.0 / damping / u.ftm2v, math.sqrt(24.0 * u.boltz * target / damping / loop.dt / u.mvv2e) / u.ftm2v, seed)
        return p

    def setup(self, loop) -> None:
        self.next_reneighbor = self._next(loop.step)

    def _next(self, step: int) -> int:
        return (step // self.interval + 1) * self.interval

    @hook
    def post_force(th, s, p, a):
        high = s.box.origin[2] + s.box.vectors[2, 2]
        frozen, warm = high - p[1], high - p[2]
        seed, step = np.uint64(p[5]), th.step
        for i in range(th.lo, th.hi):
            if s.row[i] >= 0:
                if s.x[2, i] >= frozen:
                    for d in range(3):
                        s.v[d, i] = 0.0
                        s.f[d, i] = 0.0
                elif p[2] > 0.0 and s.x[2, i] >= warm:
                    for d in range(3):
                        noise = p[4] * math.sqrt(s.mass[i]) * (uniform(seed, step, s.row[i], d) - 0.5)
                        s.f[d, i] += noise - p[3] * s.mass[i] * s.v[d, i]

    def next_list(self, step: int) -> int:
        return NEVER

    def pre_exchange(self, loop) -> None:
        """On its steps: the new atoms."""
        if loop.step != self.next_reneighbor:
            return
        self.next_reneighbor = self._next(loop.step)
        loop.sync_out()
        new = self._atoms(loop.system)
        if new is not None:
            population.insert(loop, new)

    def _atoms(self, system):
        from asemd.atom_style import fresh
        from asemd.system import System
        low, high = system.box.lo.copy(), system.box.hi.copy()
        low[2], high[2] = high[2], high[2] + self.size
        x, basis = (np.concatenate(parts) for parts in zip(*self.lattice.points(low, high)))
        keep = ((x >= low) & (x < high)).all(axis=1)
        x, basis = x[keep], basis[keep]
        if not len(x):
            return None
        if self.spread is not None:
            drawn = np.array([self.random.uniform() for _ in range(x.size)]).reshape(-1, 3)
            x = x + np.array(self.spread[:3]) * 2.0 * (drawn - 0.5)
        kinds = np.array([self.types.get(b + 1, 1) for b in basis.tolist()], np.int32)
        ids = int(system.id.max(initial=0)) + 1 + np.arange(len(x))
        return System(box=system.box, x=x, type=kinds, id=ids, units=system.units, dimension=system.dimension,
                      counts=dict(system.counts), **fresh(system.atom_style, len(x)))


def _check_seed(seed: float, what: str) -> None:
    if not 1 <= seed <= 900_000_000:
        raise InputError(f"fix append/atoms {what}: the seed must be from 1 to 900000000, got {seed:g}")
