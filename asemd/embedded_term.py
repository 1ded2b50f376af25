"""The term of an embedded-atom potential over the cluster list."""
from __future__ import annotations

import numpy as np

from asemd.errors import SimulationError
from asemd.kernels import embedded_cluster
from asemd.kernels.state import aligned
from asemd.term import FactorTerm


class EmbeddedTerm(FactorTerm):
    """See `asemd.kernels.embedded_cluster`; it knows no special pairs and no exclusions."""

    category = "pair"

    def __init__(self, term):
        self.owner, self.style, self.tables = term, term.style, term.tables
        table, offset, self.functions, function_of, self.share = term.tables.arrays
        self.function_of, self.flat = function_of.astype(np.int32), self.functions.ravel()
        cut2 = term.tables.rows[0]
        offset = np.where(cut2 > 0.0, offset, 0)[1:, 1:]
        self.cut = float(np.sqrt(cut2.max()))
        # types with the same functions are one class
        _, first, classes = np.unique(np.concatenate([offset, offset.T], axis=1), axis=0, return_index=True, return_inverse=True)
        self.class_of_type, self.classes = np.concatenate([[0.0], classes.ravel()]), float(len(first))
        size = int(term.tables.constants[2]) + 1
        blocks = [table[offset[s, t]:offset[s, t] + size].ravel() for s in first for t in first]
        self.table = aligned((len(blocks) * 8 * size,))
        self.table[:] = np.concatenate(blocks)
        self.varying = len(first) > 1
        self.longest, self.room = -1, 0

    def kernel(self, energy, per_atom):
        return self._scaled(embedded_cluster.kernel(energy=energy, varying=self.varying, outdated=self.outdated), energy)

    def rebuild(self, engine):
        clusters, nth, slots = engine.list, engine.threads, engine.state.x.shape[1]
        self.outdated = engine.settings.outdated
        if getattr(self, "rho", np.zeros((0, 0))).shape != (nth, slots):
            self.rho, self.slope, self.class_of = aligned((nth, slots)), aligned((slots,)), aligned((slots,))
            self.tables4 = aligned((nth, 2, slots, 4))
        self.class_of[:] = self.class_of_type[engine.state.type]
        longest = clusters.longest()
        # an atom of a cluster keeps no more than the cluster's row, filled up to whole vectors
        most = max(8 * int(clusters.first[t, int(high)]) + 64 * int(high - low)
                   for t, (low, high) in enumerate(zip(clusters.bounds[:-1], clusters.bounds[1:])))
        if longest > self.longest:
            self.longest = longest + longest // 8
            self.row = -(-(self.longest + 48) // 16) * 16
            stage = 8 * (self.row + 8)
            self.b, self.local = aligned((nth, 4 * self.row + 16), np.float32), aligned((nth, 4 * (self.row + 8)))
            self.b[:, 3 * self.row:] = 99.0
            self.sums, self.work = aligned((nth, 4 * (self.row + 8))), aligned((nth, 6 * stage))
            self.kinds, self.lanes = aligned((nth, 4 * (self.row + 8)), np.int32), aligned((nth, 16), np.int32)
            self.there, self.back = aligned((nth, stage), np.int32), aligned((nth, stage), np.int32)
        if most > self.room:
            self.room = most + most // 8
            self.kept, self.owners = aligned((nth, self.room + 64), np.int32), aligned((nth, self.room // 8 + 64), np.int32)
        if getattr(self, "ends", np.zeros(0)).shape != (len(clusters.own),):
            self.ends = np.zeros(len(clusters.own), np.int64)

    def relisted(self, engine):
        c = engine.list
        return [("look_at_rows", (c.row_length, self.longest)), ("look_at_pairs", (c.bounds, c.first, self.room)),
                ("place_classes", (engine.state.type, self.class_of_type, self.class_of))]

    def arguments(self, engine, tid):
        s, c = engine.state, engine.list
        f, acc = self._sums(engine, tid)
        return self._with_factor(engine, tid, (
            s.x, f, s.type, c.first[tid], c.entries[tid], c.own, c.span, c.unshifted, c.shifts4, c.ranges[tid],
            self.tables.constants, self.table, self.classes, self.class_of, self.cut, c.reach, self.functions,
            self.flat, self.function_of, self.share, self.rho, self.slope, self.b[tid], self.row, self.local[tid], self.sums[tid],
            self.kinds[tid], self.kept[tid], self.owners[tid], self.ends, self.work[tid], self.there[tid], self.back[tid], self.lanes[tid],
            *self.tables4[tid], acc, c.hide[tid], engine.settings.skin, engine.moved, engine.farthest[tid:tid + 1], c.ahead, tid,
            engine.meeting, engine.bad[tid, self.index]))

    def describe(self, engine, item, value):
        atom = int(engine.system.id[engine.state.row[int(item)]])
        return SimulationError(f"pair style {self.style.name}: the density at atom {atom} is not finite: atoms coincide, or have left the "
                               "range of the potential")
