"""Terms of `asemd.respa` for pieces of a pair force that end well before its cutoff: each has a list of its own."""
from __future__ import annotations

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.neighbor import ClusterList
from asemd.term import PairListTerm


class ShortListTerm(PairListTerm):
    """A piece of a pair force over those pairs of the list that are closer than `within` when it is built."""

    within = np.inf

    def rebuild(self, engine):
        super().rebuild(engine)
        x = engine.state.x
        d = x[:, self.i] - x[:, self.j] - self.shifts[self.code >> 2].T
        near = (d * d).sum(axis=0) < self.within**2
        self.i, self.j, self.code = self.i[near], self.j[near], self.code[near]


class ShortClusterTerm(PairTerm):
    """The same over clusters: a second list with a shorter reach, for the same slots."""

    within = np.inf
    near = None

    def rebuild(self, engine):
        whole = engine.list
        if self.near is None:
            self.near = ClusterList(engine.threads, self.within, whole.width, whole.marked)
        near = self.near
        near.slots = whole.slots
        near.shape(whole.bins, engine.system.n, (whole.nx, whole.ny, whole.nz))
        near.cell_start, near.column_start, near.column_of = whole.cell_start, whole.column_start, whole.column_of     # same slots
        near.build(engine.k, engine.state, engine.ns, engine.cell, engine.periodic, engine.exclusions.partners, engine.slot_of,
                   engine.parallel)
        super().rebuild(engine)

    def clusters(self, engine):
        return self.near
