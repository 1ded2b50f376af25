"""What fixes that break and make bonds share: when they act, who chooses whom, and the list of bonds afterwards."""
from __future__ import annotations

import numpy as np

from asemd import population
from asemd.errors import InputError
from asemd.fix import NEVER, Fix
from asemd.fix.atom_order import AtomOrder, sort_if_due, storage_of
from asemd.marsaglia import Marsaglia
from asemd.words import number, take, whole


class BondChange(Fix):
    """Base class.

    Parameters
    ----------
    group : str
        Both atoms of a bond must be in it.
    every : int
        Steps between two looks.
    bond_type : int
    distance : float
        Limit of the distance of two atoms, distance units.
    probability : float
        With which a bond that may change does.
    seed : int
        Of that choice, positive.

    Each atom that has chosen another one draws a number, in the order in which LAMMPS stores them; that of the lower id decides.

    Raises
    ------
    InputError
        A number that makes no sense.
    """

    size = 2
    extensive = False

    def __init__(self, group: str = "all", every: int = 1, bond_type: int = 1, distance: float = 1.0, probability: float = 1.0,
                 seed: int = 12345):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix {self.style}: Nevery must be at least 1, got {every}")
        if distance < 0.0:
            raise InputError(f"fix {self.style}: the distance must not be negative, got {distance:g}")
        if not 0.0 <= probability <= 1.0:
            raise InputError(f"fix {self.style} prob: the fraction must be from 0 to 1, got {probability:g}")
        self.interval, self.bond_type, self.distance, self.probability, self.seed = every, bond_type, distance, probability, seed
        self.random, self.storage, self.resumed, self.running = Marsaglia(seed), AtomOrder(), False, False
        self.now = self.total = 0

    @classmethod
    def read_probability(cls, words: list[str]) -> dict:
        """The values of ``prob``."""
        fraction, seed = take(words, 2, f"fix {cls.style} prob")
        seed = whole(seed, f"fix {cls.style} prob: seed")
        if seed < 1:
            raise InputError(f"fix {cls.style} prob: the seed must be positive, got {seed}")
        return {"probability": number(fraction, f"fix {cls.style} prob"), "seed": seed}

    @property
    def draws(self) -> bool:
        """Whether chance has a say."""
        return self.probability < 1.0

    def setup(self, loop) -> None:
        if self.draws:
            self.storage = storage_of(loop, self.storage)
            if not self.resumed:
                self.storage.sort(loop)
            self.resumed = False
        self.running = True

    def finish(self, loop) -> None:
        self.running = False

    def next_list(self, step: int) -> int:
        return max(step + 1, self.storage.due) if self.draws else NEVER

    def pre_exchange(self, loop) -> None:
        if self.draws:
            sort_if_due(loop, self.storage, self)

    def next_step(self, step: int) -> int:
        return (step // self.interval + 1) * self.interval

    def post_integrate(self, loop) -> None:
        """On its steps: change bonds, and have the list built anew if there were any."""
        if loop.step % self.interval:
            return
        loop.sync_out()
        pairs, chose = self.candidates(loop)
        if self.draws:
            drawn = np.zeros(loop.system.n)
            for row in self.storage.rows(loop.system):
                if chose[row]:
                    drawn[row] = self.random.uniform()
            first = np.argmin(loop.system.id[pairs], axis=1) if len(pairs) else np.zeros(0, np.int64)
            pairs = pairs[drawn[pairs[np.arange(len(pairs)), first]] < self.probability]
        self.now = len(pairs)
        self.total += self.now
        if self.now:
            self.change(loop, pairs)
            population.retie(loop)
            self.next_reneighbor = loop.step

    def candidates(self, loop) -> tuple[np.ndarray, np.ndarray]:
        """(m, 2) rows of pairs of atoms that have chosen each other, and (n,) which atoms have chosen one."""
        raise NotImplementedError

    def change(self, loop, pairs: np.ndarray) -> None:
        """Change the topology of the system."""
        raise NotImplementedError

    def vector(self, i: int) -> float:
        """1: bonds changed at the last look; 2: bonds changed so far."""
        if i not in (1, 2):
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 2 components, not {i}")
        return float((self.now, self.total)[i - 1])

    def state(self) -> dict:
        return {"now": self.now, "total": self.total, "stream": self.random.stream(), "ids": self.storage.ids, "due": self.storage.due,
                "running": self.running}

    def restore(self, state: dict) -> None:
        self.now, self.total = int(state["now"]), int(state["total"])
        if "stream" not in state:       # of an older file, whose numbers were others
            return
        self.random.take([float(x) for x in state["stream"]])
        self.storage.ids, self.storage.due = np.array(state["ids"], np.int64), int(state["due"])
        self.resumed = bool(state["running"])       # each run begins with a sort


def mutual(n: int, pairs: np.ndarray, rank: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pairs whose two atoms rank each other first: `pairs` (m, 2), the lowest `rank` (m,) wins, the first of equal ones; and (n,) which
    atoms are in any pair."""
    best, lowest = np.full(n, -1), np.full(n, np.inf)
    for column in (0, 1):
        order = np.argsort(-rank, kind="stable")        # the last assignment stands: that of the best
        first, value = np.full(n, -1), np.full(n, np.inf)
        first[pairs[order, column]], value[pairs[order, column]] = order, rank[order]
        better = value < lowest
        best[better], lowest[better] = first[better], value[better]
    own = np.arange(len(pairs))
    return pairs[(best[pairs[:, 0]] == own) & (best[pairs[:, 1]] == own)], best >= 0


__all__ = ["BondChange", "mutual"]
