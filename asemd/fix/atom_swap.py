r"""Monte Carlo exchanges of the types of atoms, during or instead of dynamics.

Every N steps, from the one after the fix is made, X attempts are made. By default an atom of one type and one of another exchange their
types (and charges), which is accepted with probability

$$\min\left(1, e^{-\Delta E / k_B T}\right)$$

With ``semi-grand yes`` one atom becomes another type of the list, accepted with :math:`e^{-(\Delta E - \mu_{new} + \mu_{old}) / k_B T}`:
the composition follows the chemical potentials. With ``ke yes`` velocities are scaled so that an atom keeps its kinetic energy with its
new mass. Energies are those of the whole system.

Source: B. Sadigh, P. Erhart, A. Stukowski, A. Caro, E. Martinez, L. Zepeda-Ruiz, Phys. Rev. B 85, 184203 (2012). Units: temperature,
energy. Output: a vector, attempts and successes so far.
"""
from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from asemd import population
from asemd.errors import InputError, nearest
from asemd.fix import NEVER, Fix
from asemd.kspace.term import count
from asemd.random import ParkMiller
from asemd.words import bounds, number, take, whole, yes_no

KEYWORDS = ("types", "mu", "ke", "semi-grand", "region")


class AtomSwap(Fix):
    """Exchange types.

    Parameters
    ----------
    group : str
        The atoms that may change.
    every : int
        Steps between two series of attempts.
    attempts : int
        In each series.
    seed : int
        Positive.
    temperature : float
        Of the acceptance, temperature units.
    types : sequence of int
        The types that are exchanged: two, or with `mu` two or more.
    mu : sequence of float, optional
        Chemical potentials of these types, energy units: the composition changes.
    keep_kinetic : bool
        Scale velocities by the square root of the ratio of the masses.
    region : Region, optional
        Only atoms inside it.

    Raises
    ------
    InputError
        Numbers that make no sense, other numbers of types and potentials.
    """

    style = "atom/swap"
    size = 2
    extensive = False

    def __init__(self, group: str = "all", every: int = 1, attempts: int = 1, seed: int = 1, temperature: float = 1.0,
                 types: Sequence[int] = (1, 2), mu: Sequence[float] | None = None, keep_kinetic: bool = True, region=None):
        super().__init__(group)
        if every < 1 or attempts < 0:
            raise InputError(f"fix atom/swap: N must be at least 1 and X must not be negative, got {every} and {attempts}")
        if not temperature > 0.0:
            raise InputError(f"fix atom/swap: the temperature must be positive, got {temperature:g}")
        if len(set(types)) != len(types) or len(types) < 2:
            raise InputError("fix atom/swap types: needs at least two different types")
        if mu is None and len(types) != 2:
            raise InputError(f"fix atom/swap types: an exchange is between two types, got {len(types)}; semi-grand yes takes more")
        if mu is not None and len(mu) != len(types):
            raise InputError(f"fix atom/swap mu: needs {len(types)} potentials, one for each of the types, got {len(mu)}")
        self.interval, self.attempts, self.seed, self.temperature = every, attempts, seed, temperature
        self.types, self.mu, self.keep_kinetic, self.region = tuple(types), None if mu is None else tuple(mu), keep_kinetic, region
        self.region_id = getattr(region, "id", "")
        self.random, self.choice = ParkMiller(seed), ParkMiller(seed)
        self.tried = self.done = 0

    @classmethod
    def from_lammps(cls, group, words, session):
        every, attempts, seed, temperature = take(words, 4, "fix atom/swap N X seed T")
        system, what = session.scene.system, "fix atom/swap"
        given: dict[str, list[str]] = {}
        rest = words[4:]
        while rest:
            if rest[0] not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], KEYWORDS)}")
            n = 1
            if rest[0] in ("types", "mu"):
                n = next((k for k, w in enumerate(rest[1:]) if w in KEYWORDS), len(rest) - 1)
            given[rest[0]] = take(rest[1:], n, f"{what} {rest[0]}")[:n]
            rest = rest[1 + n:]
        if "types" not in given:
            raise InputError(f"{what} needs the keyword types with at least two atom types")
        types = [bounds(w, 1, system.counts["ntypes"], f"{what} types", system.labels["atom"])[0] for w in given["types"]]
        semi = yes_no(given.get("semi-grand", ["no"])[0], f"{what} semi-grand")
        if semi != ("mu" in given):
            raise InputError(f"{what}: mu and semi-grand yes must be given together")
        region = session.scene.region(given["region"][0], what) if "region" in given else None
        fix = cls(group, whole(every, f"{what} N"), whole(attempts, f"{what} X"), whole(seed, f"{what} seed"),
                  number(temperature, f"{what} T"), types, [number(w, f"{what} mu") for w in given["mu"]] if semi else None,
                  yes_no(given.get("ke", ["yes"])[0], f"{what} ke"), region)
        fix.region_id, fix.next_reneighbor = given.get("region", [""])[0], session.scene.step + 1
        return fix

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), str(self.attempts), str(self.seed), repr(self.temperature), "ke", "yes" if self.keep_kinetic else "no"]
        words += ["types", *map(str, self.types)] + (["region", self.region_id] if self.region is not None else [])
        return words + (["semi-grand", "yes", "mu", *map(repr, self.mu)] if self.mu is not None else [])

    def setup(self, loop) -> None:
        system = loop.system
        self.charges = None
        if system.q is not None:
            self.charges = {}
            for kind in self.types:
                values = np.unique(system.q[(system.type == kind) & loop.groups[self.group]])
                if len(values) > 1 or (not len(values) and self.mu is None):
                    raise InputError(f"fix atom/swap: all atoms of type {kind} must have the same charge" if len(values) else
                                     f"fix atom/swap: there are no atoms of type {kind} in group {self.group}")
                self.charges[kind] = float(values[0]) if len(values) else 0.0
        if self.next_reneighbor < 0:        # made in Python
            self.next_reneighbor = loop.step + 1

    def next_list(self, step: int) -> int:
        return NEVER

    def pre_exchange(self, loop) -> None:
        """On its steps: the attempts."""
        if loop.step != self.next_reneighbor:
            return
        self.next_reneighbor += self.interval
        loop.sync_out()
        population.retie(loop)          # energies need a list for where the atoms are now
        inside = loop.groups[self.group].copy()
        if self.region is not None:
            inside &= self.region.inside(loop.system.x)
        self.energy = self._energy(loop)
        attempt = self._exchange if self.mu is None else self._change
        for _ in range(self.attempts):
            self.done += attempt(loop, inside)
            self.tried += 1
        population.retie(loop)

    def _energy(self, loop) -> float:
        loop.engine.forces(True)
        return loop.engine.collect().potential

    def _set(self, loop, row: int, kind: int) -> None:
        """Another type, and its charge, for one atom: in the system and in the engine."""
        system, e = loop.system, loop.engine
        slot = e.slot_of[row]
        system.type[row] = e.type_row[row] = e.state.type[slot] = kind
        if self.charges is not None:
            system.q[row] = e.q_row[row] = e.state.q[slot] = self.charges[kind]

    def _try(self, loop, changes: dict[int, int], work: float) -> bool:
        """Make changes (row -> type); keep them, or take them back."""
        before = {row: int(loop.system.type[row]) for row in changes}
        for row, kind in changes.items():
            self._set(loop, row, kind)
        if self.mu is not None:
            count(loop.engine)
        energy = self._energy(loop)
        exponent = (self.energy - energy + work) / (loop.units.boltz * self.temperature)
        decides = self.random if self.mu is None else self.choice       # a process of its own decides there
        if decides.uniform() < math.exp(min(exponent, 0.0)):
            self.energy = energy
            mass = loop.system.mass
            for row, kind in changes.items() if self.keep_kinetic and loop.system.rmass is None else ():
                loop.system.v[row] *= math.sqrt(mass[before[row]] / mass[kind])
                loop.state.v[:, loop.engine.slot_of[row]] = loop.system.v[row]
            return True
        for row, kind in before.items():
            self._set(loop, row, kind)
        return False

    def _exchange(self, loop, inside: np.ndarray) -> bool:
        """Two atoms exchange their types."""
        first, second = (np.flatnonzero(inside & (loop.system.type == kind)) for kind in self.types)
        if not len(first) or not len(second):
            return False
        i, j = (int(rows[int(len(rows) * self.random.uniform())]) for rows in (first, second))
        return self._try(loop, {i: self.types[1], j: self.types[0]}, 0.0)

    def _change(self, loop, inside: np.ndarray) -> bool:
        """One atom becomes another type of the list."""
        rows = np.flatnonzero(inside & np.isin(loop.system.type, self.types))
        if not len(rows):
            return False
        row = int(rows[int(len(rows) * self.random.uniform())])
        old = self.types.index(int(loop.system.type[row]))
        new = old
        while new == old:
            new = int(len(self.types) * self.choice.uniform())
        return self._try(loop, {row: self.types[new]}, self.mu[new] - self.mu[old])

    def vector(self, i: int) -> float:
        """1: attempts so far; 2: successes so far."""
        if i not in (1, 2):
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 2 components, not {i}")
        return float((self.tried, self.done)[i - 1])

    def state(self) -> dict:
        return {"random": self.random.state, "choice": self.choice.state, "tried": self.tried, "done": self.done,
                "next": self.next_reneighbor}

    def restore(self, state: dict) -> None:
        self.random.state, self.choice.state = int(state["random"]), int(state["choice"])
        self.tried, self.done, self.next_reneighbor = int(state["tried"]), int(state["done"]), int(state["next"])
