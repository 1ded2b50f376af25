"""The shorter list that a pair term runs over between two builds of the whole one."""
from __future__ import annotations

import numpy as np

from asemd.kernels import prune
from asemd.kernels.cluster import CLUSTER
from asemd.kernels.sieve import WIDE
from asemd.kernels.state import aligned
from asemd.neighbor import COUNTERS, ClusterList
from asemd.style import operations

PART = 0.35              # of the skin, which pruned lists begin with
MAKING, BARE, EACH = 6.0, 0.5, 0.025      # times, up to a factor: of pruning an entry, of a pair without its formula, of an operation
PRUNING = 3.0 if WIDE else MAKING         # the first as it is on this processor; which styles have pruned lists does not depend on it
ENTRY = 6.8              # pairs that kernels compute for an entry of the list
INTERVAL = 3             # force evaluations for which a pruned list serves, at least


class PrunedList:
    """What is within the cutoff and a part of the skin, made anew by the kernel itself; see `asemd.kernels.prune`.

    Attributes
    ----------
    first, entries, own, span, excluded_first, excluded, hide
        As of `asemd.neighbor.ClusterList`.
    """

    def __init__(self, threads: int, skin: float, cut: float, style):
        self.memo = aligned((threads, 8))
        self.memo[:, prune.SKIN], self.memo[:, prune.MOST], self.memo[:, prune.CUT] = PART * skin, skin, cut
        self.memo[:, prune.COST] = PRUNING / (ENTRY * (BARE + EACH * operations(*style.functions())))
        self.seen = np.zeros((threads, 3, 0))
        self.first = self.entries = self.excluded = np.zeros((threads, 0), np.int32)
        self.own = np.zeros(0, np.int32)
        self.codes = self.to = np.zeros((threads, 0), np.int64)

    @staticmethod
    def pays(skin: float, cut: float, density: float, style) -> bool:
        """Whether the pairs it saves cost more than making it: it does for long formulas and a large skin.

        `density` of atoms tells how far a cluster extends, whose atoms share their entries.
        """
        around = 0.35 * (CLUSTER / max(density, 1e-300)) ** (1 / 3)
        less = 1.0 - ((cut + PART * skin + around) / (cut + skin + around)) ** 3
        return ENTRY * less * (BARE + EACH * operations(*style.functions())) > MAKING / INTERVAL

    @property
    def renewals(self) -> int:
        """How often it was made."""
        return int(self.memo[0, prune.RENEWALS])

    def rebuild(self, clusters: ClusterList, x: np.ndarray, row: int, empty: int) -> None:
        """There is a new whole list, in slots at `x (3, slots)`, of rows up to the length `row`."""
        threads, slots = len(self.memo), x.shape[1]
        if self.seen.shape[2] != slots:
            self.seen, self.seen_shifts = aligned((threads, 3, slots)), np.zeros((threads, 27, 4))
        if self.first.shape != clusters.first.shape:
            self.first, self.excluded_first = np.zeros_like(clusters.first), np.zeros_like(clusters.first)
        if self.own.shape != clusters.own.shape:
            self.own, self.span = np.zeros_like(clusters.own), np.zeros_like(clusters.span)
        if self.entries.shape != clusters.entries.shape:
            self.entries = np.empty_like(clusters.entries)
            self.hide = np.empty((threads, clusters.entries.shape[1] if clusters.marked else 0), np.uint8)
        if self.excluded.shape != clusters.excluded.shape:
            self.excluded = np.empty_like(clusters.excluded)
        if self.to.shape[1] != row:
            self.to = np.zeros((threads, row), np.int64)
            self.codes = np.zeros((threads, 0 if WIDE else row), np.int64)
            self.room, self.short = aligned((threads, 0 if WIDE else 3 * row)), aligned((threads, 3 * row * WIDE), np.float32)
            self.tally = aligned((threads, 8), np.int64)
        self.memo[:, prune.VALID] = 0.0
        self.width, self.empty = clusters.width, empty

    def whole(self, clusters: ClusterList, tid: int, of_thread) -> prune.Whole:
        """What a thread's kernel makes it of; `of_thread` gives the thread's rows of arrays."""
        first, entries, *mine = of_thread(
            tid, clusters.first, clusters.entries, clusters.excluded_first, clusters.excluded,
            clusters.hide if clusters.marked else self.hide, self.seen, self.seen_shifts, self.memo, self.room, self.short, self.codes,
            self.to, self.tally)
        return prune.Whole(first, entries, clusters.own, *mine, COUNTERS, self.width, self.empty)
