r"""Take atoms or molecules out of a region now and then, as a solvent that dries.

Every N steps M of the atoms of the group in the region are chosen at random and taken out, with their whole molecules if asked for: then
atoms are counted until there are M or more. LAMMPS draws from its atoms in the order of their storage, asemd in that of their rows: the
same numbers choose other atoms.

Source: LAMMPS manual, fix evaporate. Output: a scalar, how many atoms went so far.
"""
from __future__ import annotations

import numpy as np

from asemd import population
from asemd.errors import InputError, nearest
from asemd.fix import Fix
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
        self.taken = 0

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
        fix.region_id = name
        if not molecules and (scene.system.molecule[scene.groups.mask(group)] != 0).any():
            session.warn("fix evaporate may delete atoms of molecules: use molecule yes to delete whole ones")
        return fix

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), str(self.count), getattr(self, "region_id", self.region.id), str(self.seed)]
        return words + ["molecule", "yes"] * self.molecules

    def setup(self, loop) -> None:
        if self.next_reneighbor <= loop.step:
            self.next_reneighbor = self._next(loop.step)

    def _next(self, step: int) -> int:
        return (step // self.interval + 1) * self.interval

    def pre_exchange(self, loop) -> None:
        """On its steps: choose and take."""
        if loop.step != self.next_reneighbor:
            return
        self.next_reneighbor = self._next(loop.step)
        loop.sync_out()
        system = loop.system
        inside = loop.groups[self.group] & self.region.inside(system.x)
        candidates = list(np.flatnonzero(inside))
        gone: set[int] = set()
        while candidates and len(gone) < self.count:
            at = int(len(candidates) * self.random.uniform())
            row = candidates[at]
            candidates[at] = candidates[-1]
            candidates.pop()
            if not self.molecules or system.molecule[row] == 0:
                gone.add(int(row))
            else:
                whole_one = np.flatnonzero(system.molecule == system.molecule[row])
                gone.update(map(int, whole_one))
                candidates = [c for c in candidates if c not in gone]
        if gone:
            population.remove(loop, sorted(gone), lost=False, listed=False)
            self.taken += len(gone)

    def scalar(self) -> float:
        return float(self.taken)

    def state(self) -> dict:
        return {"taken": self.taken, "random": self.random.state, "next": self.next_reneighbor}

    def restore(self, state: dict) -> None:
        self.taken, self.random.state, self.next_reneighbor = int(state["taken"]), int(state["random"]), int(state["next"])
