r"""Take atoms or molecules out of a region now and then, as a solvent that dries.

Every N steps M of the atoms of the group in the region are chosen at random and taken out, with their whole molecules if asked for: then
atoms are counted until there are M or more. The random numbers are LAMMPS's, and the order of the atoms from which they choose, that of its
storage on one processor (see `asemd.fix.atom_order`).

Source: LAMMPS manual, fix evaporate. Output: a scalar, how many atoms went so far.
"""
from __future__ import annotations

import numpy as np

from asemd import population
from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.fix.atom_order import AtomOrder, sort_if_due, storage_of
from asemd.random import ParkMiller
from asemd.words import take, whole, yes_no


class Evaporate(Fix):
    """Take atoms out.

    Parameters
    ----------
    group : str
        The atoms it may take.
    every : int
        Steps between two times.
    count : int
        How many atoms go each time.
    region : Region
        Where from.
    seed : int
        Of the random choice, positive.
    molecules : bool
        Whole molecules go with their atoms.

    Raises
    ------
    InputError
        A number that is not positive, a region that moves.
    """

    style = "evaporate"
    extensive = False

    def __init__(self, group: str = "all", every: int = 1, count: int = 1, region=None, seed: int = 1, molecules: bool = False):
        super().__init__(group)
        if every < 1 or count < 1:
            raise InputError(f"fix evaporate: N and M must be at least 1, got {every} and {count}")
        if region is None:
            raise InputError("fix evaporate needs a region to take atoms from")
        self.interval, self.count, self.region, self.molecules = every, count, region, molecules
        self.seed, self.random = seed, ParkMiller(seed)
        self.random.skip(30)        # as LAMMPS: the first numbers of neighbouring seeds are alike
        self.taken, self.storage, self.resumed, self.running = 0, AtomOrder(), False, False

    @classmethod
    def from_lammps(cls, group, words, session):
        every, count, name, seed = take(words, 4, "fix evaporate N M region-ID seed")
        molecules, rest = False, words[4:]
        while rest:
            if rest[0] != "molecule":
                raise InputError(f"fix evaporate: unknown keyword {rest[0]!r}{nearest(rest[0], ('molecule',))}")
            molecules, rest = yes_no(take(rest[1:], 1, "fix evaporate molecule")[0], "fix evaporate molecule"), rest[2:]
        scene = session.scene
        if molecules and not scene.system.molecular:
            raise InputError(f"fix evaporate molecule yes: atoms of style {scene.system.atom_style} have no molecules")
        fix = cls(group, whole(every, "fix evaporate N"), whole(count, "fix evaporate M"), scene.region(name, "fix evaporate"),
                  whole(seed, "fix evaporate seed"), molecules)
        fix.region_id, fix.storage = name, AtomOrder(*scene.sort, scene.order)
        if not molecules and (scene.system.molecule[scene.groups.mask(group)] != 0).any():
            session.warn("fix evaporate may delete atoms of molecules: use molecule yes to delete whole ones")
        return fix

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), str(self.count), getattr(self, "region_id", self.region.id), str(self.seed)]
        return words + ["molecule", "yes"] * self.molecules

    def setup(self, loop) -> None:
        self.storage = storage_of(loop, self.storage)
        if not self.resumed:
            self.storage.sort(loop)
        self.resumed, self.running = False, True
        if self.next_reneighbor <= loop.step:
            self.next_reneighbor = self._next(loop.step)

    def finish(self, loop) -> None:
        self.running = False

    def _next(self, step: int) -> int:
        return (step // self.interval + 1) * self.interval

    def next_list(self, step: int) -> int:
        return max(step + 1, self.storage.due)

    def pre_exchange(self, loop) -> None:
        """On its steps: choose and take."""
        if loop.step == self.next_reneighbor:
            self.next_reneighbor = self._next(loop.step)
            gone = self._chosen(loop)
            if len(gone):
                self.storage.remove(loop.system.id[gone])
                population.remove(loop, gone, lost=False, listed=False)
                self.taken += len(gone)
        sort_if_due(loop, self.storage, self)

    def _chosen(self, loop) -> np.ndarray:
        """Rows of those that go."""
        system = loop.system
        gone = np.zeros(system.n, bool)
        inside = self.region.inside(population.places(loop)) & loop.groups[self.group]
        stored = self.storage.rows(system)
        candidates = stored[inside[stored]]
        if not self.molecules:
            left = len(candidates)
            while left and len(candidates) - left < self.count:
                at = int(left * self.random.uniform())
                left -= 1
                candidates[at], candidates[left] = candidates[left], candidates[at]
            return np.sort(candidates[left:])
        candidates = candidates.tolist()
        while candidates and np.count_nonzero(gone) < self.count:
            at = int(len(candidates) * self.random.uniform())
            row = candidates[at]
            gone[row] = True
            if system.molecule[row] != 0:
                gone |= system.molecule == system.molecule[row]
            k = 0
            while k < len(candidates):      # the last one takes the place of one that goes
                if gone[candidates[k]]:
                    candidates[k] = candidates[-1]
                    candidates.pop()
                else:
                    k += 1
        return np.flatnonzero(gone)

    def scalar(self) -> float:
        return float(self.taken)

    def state(self) -> dict:
        return {"taken": self.taken, "random": self.random.state, "next": self.next_reneighbor, "ids": self.storage.ids,
                "due": self.storage.due, "running": self.running}

    def restore(self, state: dict) -> None:
        self.taken, self.random.state, self.next_reneighbor = int(state["taken"]), int(state["random"]), int(state["next"])
        self.resumed = bool(state.get("running", True))       # each run begins with a sort
        self.storage.ids, self.storage.due = np.array(state["ids"], np.int64), int(state["due"])
