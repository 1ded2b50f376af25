r"""Put atoms or molecules into a region now and then, as in vapour deposition or sputtering.

Every M steps one particle is put at a random place of the region, until there were N. With ``near R`` places closer than R to an atom are
refused and up to ``attempt`` others tried; ``global lo hi`` and ``local lo hi delta`` put it above the highest atom, of all or of those
that are laterally nearer than delta; ``rate V`` lets the region rise. Molecules are turned at random. Velocities are random within the
ranges ``vx vy vz``, or point to ``target``. ``rigid`` and ``shake`` name a fix of such a style that is to hold the molecules, with the same
template (``mol``). Random numbers are LAMMPS's, so particles come to the same places.

Source: LAMMPS manual, fix deposit. Units: distance, velocity; with ``units lattice``, the default of scripts, lengths count in lattice
spacings. The first particle comes on the step after the fix is made.
"""
from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from asemd import population
from asemd.errors import InputError, nearest
from asemd.fix import NEVER, Fix
from asemd.fix import holder as holders
from asemd.kernels import nearest as near_atoms
from asemd.molecule import rotation, turned
from asemd.random import ParkMiller
from asemd.words import bounds, choice, number, take, whole

VALUES = {"region": 1, "id": 1, "global": 2, "local": 3, "near": 1, "attempt": 1, "rate": 1, "vx": 2, "vy": 2, "vz": 2, "target": 3,
          "orient": 3, "gaussian": 4, "mol": 1, "molfrac": 0, "units": 1, "var": 1, "set": 2, "rigid": 1, "shake": 1}


class Deposit(Fix):
    """Put particles in.

    Parameters
    ----------
    group : str
        The group they belong to besides ``all``.
    count : int
        How many particles.
    kind : int
        Atom type; for molecules it is added to their types.
    every : int
        Steps from one particle to the next.
    seed : int
        Of all that is random, positive.
    region : Region
        Where to.
    near : float
        No atom may be nearer, distance units.
    attempts : int
        Places tried for one particle.
    velocity : sequence of 3 pairs of float
        Lowest and highest x, y and z velocity, velocity units.
    above : (float, float), optional
        Lowest and highest distance above the highest atom.
    lateral : float, optional
        With `above`: only atoms that are laterally nearer count.
    rate : float
        Velocity at which the region rises.
    target : sequence of 3 float, optional
        The velocity points there.
    gaussian : sequence of 4 float, optional
        Centre and width of a normal distribution of places.
    molecules : sequence of Molecule, optional
        What comes instead of single atoms.
    fractions : sequence of float, optional
        How often each molecule comes.
    orient : sequence of 3 float, optional
        Axis that molecules are turned about.
    next_ids : bool
        Ids count on from the largest one at the start, also if atoms left.
    test : callable, optional
        A place (3,) -> whether it may be used.
    holder : (str, str), optional
        ``rigid`` or ``shake`` and the id of the fix of such a style that is to hold the molecules, whose `template` is that of this one.

    Raises
    ------
    InputError
        No region, one without end or one that moves; numbers that make no sense.
    """

    style = "deposit"

    def __init__(self, group: str = "all", count: int = 1, kind: int = 1, every: int = 1, seed: int = 1, region=None, near: float = 0.0,
                 attempts: int = 10, velocity: Sequence[tuple[float, float]] = ((0.0, 0.0),) * 3, above: tuple[float, float] | None = None,
                 lateral: float | None = None, rate: float = 0.0, target=None, gaussian=None, molecules=(), fractions=None, orient=None,
                 next_ids: bool = False, test=None, holder: tuple[str, str] | None = None):
        super().__init__(group)
        if region is None:
            raise InputError("fix deposit needs a region")
        if region.extent() is None:
            raise InputError("fix deposit: the region must have an end, be of side in and not move")
        if every < 1 or attempts < 1 or count < 0 or near < 0.0:
            raise InputError("fix deposit: M and attempt must be at least 1, N and near must not be negative")
        if fractions is not None and (len(fractions) != len(molecules) or abs(sum(fractions) - 1.0) > 1e-10 or min(fractions) < 0.0):
            raise InputError(f"fix deposit molfrac: needs {len(molecules)} fractions that add up to 1")
        self.count, self.kind, self.interval, self.seed, self.region = count, kind, every, seed, region
        self.near, self.attempts, self.velocity, self.above, self.lateral = near, attempts, velocity, above, lateral
        self.rate, self.target, self.gaussian, self.orient = rate, target, gaussian, orient
        self.molecules, self.next_ids, self.test = list(molecules), next_ids, test
        self.fractions = np.cumsum(fractions if fractions is not None else np.full(len(self.molecules), 1.0 / max(1, len(molecules))))
        self.random = ParkMiller(seed)
        self.random.skip(30)        # as LAMMPS: the first numbers of neighbouring seeds are alike
        self.inserted = 0
        self.first: int | None = None
        self.last_ids = [0, 0]      # of atoms and molecules, with `next_ids`
        self.words: list[str] = []
        self.holder, self.template, self.holds = holder, "", None
        self.single = None      # a System of one atom to be copied

    @classmethod
    def from_lammps(cls, group, words, session):
        count, kind, every, seed = take(words, 4, "fix deposit N type M seed")
        scene = session.scene
        given = _read(words[4:])
        holder = holders.read(given, "fix deposit")
        if "region" not in given:
            raise InputError("fix deposit needs the keyword region")
        if ("var" in given) != ("set" in given):
            raise InputError("fix deposit: the keywords var and set must be given together")
        molecules = []
        if "mol" in given:
            name = given["mol"][0]
            if name not in scene.molecules:
                raise InputError(f"fix deposit mol: there is no molecule {name}{nearest(name, scene.molecules)}")
            molecules = list(scene.molecules[name])
            for one in molecules:
                one.check(scene.system, "fix deposit mol", whole(kind, "fix deposit type"))
        elif "molfrac" in given or "orient" in given:
            raise InputError("fix deposit: molfrac and orient need the keyword mol")
        numbers = {k: [number(w, f"fix deposit {k}") for w in v] for k, v in given.items()
                   if k in ("global", "local", "near", "rate", "vx", "vy", "vz", "target", "orient", "gaussian", "molfrac")}
        lattice = choice(given.get("units", ["lattice"])[0], ("lattice", "box"), "fix deposit units") == "lattice"
        sx, sy, sz = scene.lattice.spacings if lattice and scene.lattice is not None else np.ones(3)
        up = sy if scene.dimension == 2 else sz
        above = lateral = None
        if "global" in numbers or "local" in numbers:
            values = numbers.get("local") or numbers["global"]
            above, lateral = (values[0] * up, values[1] * up), values[2] * sx if "local" in numbers else None
        velocity = [tuple(v * s for v in numbers.get(k, (0.0, 0.0))) for k, s in (("vx", sx), ("vy", sy), ("vz", sz))]
        types = scene.system.counts["ntypes"]
        what = "fix deposit type"
        kind = whole(kind, what) if molecules else bounds(kind, 1, types, what, scene.system.labels["atom"])[0]
        fix = cls(group, whole(count, "fix deposit N"), kind, whole(every, "fix deposit M"), whole(seed, "fix deposit seed"),
                  scene.region(given["region"][0], "fix deposit"), numbers.get("near", [0.0])[0] * sx,
                  whole(given.get("attempt", ["10"])[0], "fix deposit attempt"), velocity, above, lateral,
                  numbers.get("rate", [0.0])[0] * up, _scaled(numbers.get("target"), (sx, sy, sz)),
                  _scaled(numbers.get("gaussian"), (sx, sy, sz, sx)), molecules, numbers.get("molfrac"), numbers.get("orient"),
                  choice(given.get("id", ["max"])[0], ("max", "next"), "fix deposit id") == "next", _test(given, session), holder)
        fix.template = given.get("mol", [""])[0]
        fix.words, fix.next_reneighbor, fix.first = list(words), scene.step + 1, scene.step + 1
        fix.check_inside(scene.system.box)
        return fix

    def check_inside(self, box) -> None:
        """The region must be in the box, but for faces that follow the atoms.

        Raises
        ------
        InputError
        """
        low, high = self.region.extent()
        if box.is_lammps_frame and not box.triclinic:
            for a, axis in enumerate("xyz"):
                follows = box.boundary[a][0] in "sm", box.boundary[a][1] in "sm"
                if (low[a] < box.lo[a] and not follows[0]) or (high[a] > box.hi[a] and not follows[1]):
                    raise InputError(f"fix deposit: the region extends along {axis} from {low[a]:g} to {high[a]:g}, beyond the box")

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError("fix deposit: this one was made in Python and has no script form")
        return self.words

    def setup(self, loop) -> None:
        self.single = None
        if self.first is None:      # made in Python
            self.first = self.next_reneighbor = loop.step + 1
        self.holds = holders.find(loop, self.holder, self.template, "fix deposit") if self.holder else None
        if self.next_ids and not any(self.last_ids):
            self.last_ids = [int(loop.system.id.max(initial=0)), int(loop.system.molecule.max(initial=0))]

    def next_list(self, step: int) -> int:
        return NEVER

    def pre_exchange(self, loop) -> None:
        """On its steps: find a place and put a particle there."""
        if loop.step != self.next_reneighbor:
            return
        there = population.places(loop)
        for _ in range(self.attempts):
            found = self._try(loop, there)
            if found is not None:
                if self.holds is not None:
                    self.holds.take_in(loop.system, *found[:2], [found[2]])
                found = found[0]
                population.insert(loop, found, [self.group], listed=False)
                self.inserted += 1
                break
        else:
            loop.warn(f"fix deposit {self.id}: step {loop.step}: no place found for a particle")
        self.next_reneighbor = self.next_reneighbor + self.interval if self.inserted < self.count else -1

    def _place(self, loop) -> np.ndarray:
        """A random place of the region."""
        low, high = self.region.extent()
        while True:
            if self.gaussian is not None:
                x = np.array([m + self.random.gaussian() * self.gaussian[3] for m in self.gaussian[:3]])
            else:
                x = np.array([a + self.random.uniform() * (b - a) for a, b in zip(low, high)])
            if self.region.inside(x[None])[0]:
                return x

    def _try(self, loop, there: np.ndarray):
        """One trial: the new atoms as a system, their molecule and how it is turned, or None if one of those `there` (n, 3) is too near."""
        system = loop.system
        up = system.dimension - 1
        place = self._place(loop)
        if self.test is not None and not self.test(place):
            return None
        place[up] += (loop.step - self.first + self.interval) * loop.dt * self.rate
        if self.above is not None:
            heights = there[:, up]
            if self.lateral is not None:
                d = _closest(place - there, system.box)
                heights = heights[(d[:, :up] ** 2).sum(axis=1) <= self.lateral**2]
            top = max(float(heights.max(initial=-np.inf)), float(system.box.origin[up]))
            low, high = self.above
            place[up] = top + low + self.random.uniform() * (high - low)
        one, matrix = self._turned(system) if self.molecules else (None, None)
        at = place[None] if one is None else turned(matrix, one.centred) + place
        e = loop.engine
        if near_atoms.kernel()(at, there.T, self.near**2, e.inverse, e.vectors, e.periodic):
            return None
        new = self._atom(system, place) if one is None else one.copies(at[None], system, self.kind, [matrix])
        v = np.array([a + self.random.uniform() * (b - a) for a, b in self.velocity])
        if self.target is not None:
            towards = np.asarray(self.target) - place
            length = math.sqrt(float(towards @ towards))
            if length > 0.0:
                v = towards / length * math.sqrt(float(v @ v))
        new.v[:] = v
        new.id += self.last_ids[0] if self.next_ids else int(system.id.max(initial=0))
        numbers = self.last_ids[1] if self.next_ids else int(system.molecule.max(initial=0))
        new.molecule[new.molecule > 0] += numbers
        self.last_ids = [max(self.last_ids[0], int(new.id.max())), max(self.last_ids[1], int(new.molecule.max(initial=0)))]
        return new, one, matrix

    def _atom(self, system, x: np.ndarray):
        from asemd.atom_style import fresh
        from asemd.system import System
        if self.single is None:
            self.single = System(box=system.box, x=x[None], type=np.array([self.kind]), units=system.units, dimension=system.dimension,
                                 counts=dict(system.counts), **fresh(system.atom_style, 1))
        one = object.__new__(System)
        vars(one).update(vars(self.single))
        one.box, one.x, one.v, one.id = system.box, x[None], np.zeros((1, 3)), np.ones(1, np.int64)
        return one

    def _turned(self, system):
        """A molecule and how it is turned."""
        which = int(np.searchsorted(self.fractions, self.random.uniform())) if len(self.molecules) else 0
        one = self.molecules[min(which, len(self.molecules) - 1)]
        axis = [0.0, 0.0, 1.0]
        if system.dimension == 3:
            axis = self.orient if self.orient is not None else [self.random.uniform() - 0.5 for _ in range(3)]
            axis = np.asarray(axis, float) / math.sqrt(sum(a * a for a in axis))
        return one, rotation(axis, self.random.uniform() * (2.0 * math.pi))

    def state(self) -> dict:
        return {"random": self.random.state, "inserted": self.inserted, "first": self.first, "next": self.next_reneighbor,
                "last_ids": list(self.last_ids)}

    def restore(self, state: dict) -> None:
        self.random.state, self.inserted, self.first = int(state["random"]), int(state["inserted"]), int(state["first"])
        self.next_reneighbor, self.last_ids = int(state["next"]), [int(i) for i in state["last_ids"]]


def _read(words: list[str]) -> dict[str, list[str]]:
    """Keywords and their values."""
    given: dict[str, list[str]] = {}
    while words:
        key = words[0]
        if key not in VALUES:
            raise InputError(f"fix deposit: unknown keyword {key!r}{nearest(key, VALUES)}")
        n = VALUES[key]
        if key == "molfrac":
            n = next((k for k, w in enumerate(words[1:]) if w in VALUES), len(words) - 1)
        values = take(words[1:], n, f"fix deposit {key}")
        given[f"set {values[0]}" if key == "set" else key] = values
        if key == "set":
            given["set"] = values
        words = words[1 + n:]
    return given


def _test(given: Mapping[str, list[str]], session):
    """``var`` and ``set``: a formula that sees the place in internal variables."""
    if "var" not in given:
        return None
    variables = session.variables
    variables.find(given["var"][0])
    axes = {"xyz".index(choice(v[0], "xyz", "fix deposit set")): v[1] for k, v in given.items() if k.startswith("set ")}
    for name in axes.values():
        if variables.find(name).style != "internal":
            raise InputError(f"fix deposit set: variable {name} must be of style internal")

    def test(place) -> bool:
        for axis, name in axes.items():
            variables.define(name, "internal", [repr(float(place[axis]))])
        return variables.number(given["var"][0]) != 0.0
    return test


def _scaled(values, scales):
    return None if values is None else [v * s for v, s in zip(values, scales)]


def _closest(d: np.ndarray, box) -> np.ndarray:
    """Differences (n, 3) as closest images."""
    s = d @ box.inverse
    return d - np.where(box.periodic, np.rint(s), 0.0) @ box.cell


__all__ = ["Deposit"]
