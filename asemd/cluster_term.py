"""The term of a pair style over the cluster list."""
from __future__ import annotations

import numpy as np

from asemd.cheaper import cheaper
from asemd.errors import SimulationError
from asemd.kernels import pair as pair_kernels
from asemd.kernels.pair_cluster import ROWS, SETS
from asemd.kernels.state import aligned
from asemd.pruned import PrunedList
from asemd.term import FactorTerm


class PairTerm(FactorTerm):
    """A pair style over the cluster list; `piece` of any pair term: only this part of a force that is split (`asemd.kernels.pair`)."""

    category = "pair"
    piece = ""
    share_room: tuple[np.ndarray, np.ndarray] | None = None      # see `asemd.atom_shares`
    pruned: PrunedList | None = None

    def __init__(self, term, single: bool):
        self.owner, self.style, self.tables, self.single = term, term.style, term.tables, single
        self.uniform = pair_kernels.uniform_rows(self.tables.rows)
        self.fast, _, self.same = cheaper(self.style, self.tables, self.uniform, single)
        self.row = 0
        self.tables4 = np.zeros((1, 2, 0, 4))
        self._views: dict[tuple[int, int], tuple] = {}

    def kernel(self, energy, per_atom, virial=False):
        return self._scaled(pair_kernels.cluster_kernel(self.fast, self.same, self.row, energy=energy, exclude=self.exclude,
                                                        single=self.single, outdated=self.outdated, piece=self.piece,
                                                        pruned=self.pruned is not None, virial=virial or energy and not self.single)[0],
                            energy or virial)

    def virial_kernel(self):
        return self.kernel(False, False, virial=True)

    def clusters(self, engine):
        """The `asemd.neighbor.ClusterList` it runs over."""
        return engine.list

    def prunes(self, engine) -> bool:
        """Whether it runs over a shorter list than the engine's."""
        skin = engine.settings.skin
        return PrunedList.pays(skin, self.clusters(engine).reach - skin, engine.system.n / engine.volume, self.fast)

    def rebuild(self, engine):
        clusters, slots = self.clusters(engine), engine.state.x.shape[1]
        if self.tables4.shape[2] != slots:
            self.tables4 = aligned((engine.threads, 2, slots, 4))
            self._tables_of = [tuple(mine) for mine in self.tables4]
        self.outdated = engine.settings.outdated
        self.exclude = engine.exclusions.partners is not None
        row = pair_kernels.row_length(clusters.longest())
        if row > self.row:
            engine.changed = True
            self.row = pair_kernels.row_length(int(1.15 * clusters.longest()))
            real = np.float32 if self.single else np.float64
            self.buffer = aligned((engine.threads, ROWS * self.row), real)
            sets = SETS * pair_kernels.buffer_rows(len(self.same) - sum(self.same))
            self.coefficients = aligned((engine.threads, sets * self.row + 16), real)
            self.held = aligned((engine.threads, 16), np.uint32)        # a line of the cache for each thread, of which SETS are used
            self.types = np.zeros((engine.threads, self.row), np.uint32)
            self.saved = np.zeros((engine.threads, self.row), real)
            self.take_tables()
        if self.pruned is None and self.prunes(engine):
            skin = engine.settings.skin
            self.pruned = PrunedList(engine.threads, skin, clusters.reach - skin, self.fast)
        if self.pruned is not None:
            self.pruned.rebuild(clusters, engine.state.x, self.row, engine.ns)

    def relisted(self, engine):
        return None if self.pruned is not None else [("look_at_rows", (engine.list.row_length, pair_kernels.most_neighbours(self.row)))]

    def fits(self, tables) -> bool:
        """Whether the kernel can go on with other coefficients and constants."""
        return (pair_kernels.uniform_rows(tables.rows) == self.uniform
                and cheaper(self.style, tables, self.uniform, self.single)[0] is self.fast)

    def take_tables(self) -> None:
        """Coefficients and constants of the tables as the kernel takes them."""
        _, tables, same = cheaper(self.style, self.tables, self.uniform, self.single)
        self.rows = pair_kernels.varying_rows(tables.rows, same)
        self.p = pair_kernels.cluster_tuple(tables.rows, tables.constants, same, self.single)

    def arguments(self, engine, tid):
        s, c = engine.state, self.clusters(engine)
        f, acc = self._sums(engine, tid)
        near = c if self.pruned is None else self.pruned
        first, entries, excluded_first, excluded, hide, *room = self._mine(
            tid, near.first, near.entries, near.excluded_first, near.excluded, near.hide, self.buffer, self.coefficients, self.held,
            self.types, self.saved)
        whole = () if self.pruned is None else self.pruned.whole(c, tid, self._mine)
        return self._with_factor(engine, tid, (
            s.x, f, s.q, s.type, first, entries, near.own, near.span, c.unshifted, c.shifts4, excluded_first, excluded, c.ranges[tid],
            self.p, self.rows, 1e3 * c.reach, engine.qqr2e, *room, *self._tables_of[tid], acc, hide,
            engine.settings.skin, engine.moved, engine.farthest[tid:tid + 1], c.ahead, whole))

    def _mine(self, tid: int, *arrays: np.ndarray) -> tuple[np.ndarray, ...]:
        """A thread's rows of arrays; the same views as long as the arrays are the same, for new ones take time to be packed."""
        key = tid, len(arrays)
        known = self._views.get(key)
        if known is None or any(a is not b for a, b in zip(known[0], arrays)):
            known = self._views[key] = arrays, tuple(a[tid] for a in arrays)
        return known[1]

    def describe(self, engine, item, value):
        return SimulationError(f"pair style {self.style.name}: energy or force is not finite")


def has_single(style) -> bool:
    """Whether a pair style has kernels in single precision, which mixed precision takes."""
    return bool(style.parts) and not style.listed and not any(part.arrays for part in style.parts)


def in_double(engine) -> tuple[list[str], str]:
    """Pair styles of a scene that are computed in double precision even if mixed precision is asked for, and why."""
    names = list(dict.fromkeys(t.style.name for t in engine.pair_terms + engine.many_terms))
    mixed = {t.style.name for t in engine.terms if isinstance(t, PairTerm)}
    stay = [name for name in names if name not in mixed]
    without = [name for name in stay if not any(t.style.name == name and has_single(t.style) for t in engine.pair_terms)]
    if without or engine.mode == "none":
        return stay, f"no kernel in single precision for {', '.join(without)}" if stay != without else "no kernel in single precision"
    return stay, "a sub-style with a factor for each atom" if engine.expanded else engine.why
