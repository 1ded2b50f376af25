"""Each atom's share of energy and virial, from kernels that are run for it."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.embedded_term import EmbeddedTerm
from asemd.kernels import pair as pair_kernels
from asemd.kernels import rows as by_row
from asemd.kernels.cluster import CLUSTER
from asemd.kernels.hooks import bound
from asemd.kernels.state import aligned
from asemd.manybody_term import ManyBodyTerm
from asemd.noise_term import NoiseTerm
from asemd.result import Result
from asemd.site_terms import OnSites
from asemd.term import PairRowsTerm

if TYPE_CHECKING:
    from asemd.engine import Engine


KINDS = {"energies", "virials"}


class Room:
    """Arrays that kernels for shares write to, kept by the engine: tables by slot (see `asemd.kernels.pair_shares`); columns, forces and
    sums for kernels that give forces as well, which nobody reads."""

    def __init__(self, engine: Engine):
        self.shape = (engine.threads, engine.state.x.shape[1])
        self.front, self.back = aligned((*self.shape, 4)), aligned((*self.shape, 4))
        self._columns: tuple[np.ndarray, ...] = ()

    def columns(self, engine: Engine) -> tuple[np.ndarray, ...]:
        """For forces, sums, energies (threads, slots) and virials (threads, 6, slots)."""
        if not self._columns:
            threads, slots = self.shape
            self._columns = (aligned(engine.buffers.shape), np.zeros_like(engine.acc), np.zeros(self.shape), np.zeros((threads, 6, slots)))
        return self._columns


def fleeting(fixes, kinds, interactions) -> bool:
    """Whether shares must be taken with the forces: when the step is over the box, or velocities that forces depend on, are others."""
    moved = any(f.box_moves and "end_of_step" in hooks for f, hooks in zip(fixes, kinds))
    return moved or any(use.style.stirred for use in interactions.uses["pair"])


def add(engine: Engine, result: Result, energies: bool = True, virials: bool = True) -> Result:
    """Add `energies`, `virials` and their parts by category to the result of the engine's last evaluation, unless they are there."""
    energies, virials = energies and result.energies is None, virials and result.virials is None
    if not (energies or virials):
        return result
    if engine.shares is None or engine.shares.shape != (engine.threads, engine.state.x.shape[1]):
        engine.shares = Room(engine)
    n = engine.system.n
    shares: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for t in engine.terms:
        if t.category not in shares:
            shares[t.category] = np.zeros(n if energies else 0), np.zeros((n if virials else 0, 6))
        of = _of_pairs if isinstance(t, (PairTerm, PairRowsTerm)) else _of_others
        if isinstance(t, OnSites):
            mine = np.zeros(n if energies else 0), np.zeros((n if virials else 0, 6))
            of(engine, t, energies, virials, *mine)
            t.hand_over(engine, *mine)
            for total, part in zip(shares[t.category], mine):
                total += part
        else:
            of(engine, t, energies, virials, *shares[t.category])
    if energies:
        result.energies_of = {category: e for category, (e, _) in shares.items()}
        result.energies = _total(list(result.energies_of.values()), (n,))
    if virials:
        result.virials_of = {category: v for category, (_, v) in shares.items()}
        result.virials = _total(list(result.virials_of.values()), (n, 6))
    return result


def _total(parts: list[np.ndarray], shape: tuple[int, ...]) -> np.ndarray:
    if len(parts) < 2:
        return parts[0] if parts else np.zeros(shape)
    out = parts[0] + parts[1]       # in place from here on: fresh memory costs more than the sums
    for part in parts[2:]:
        out += part
    return out


def _of_pairs(engine: Engine, t: PairTerm | PairRowsTerm, energies: bool, virials: bool, energy: np.ndarray, virial: np.ndarray) -> None:
    """Pair terms over clusters and over rows have kernels of their own for it, which write no forces."""
    seen = t.sighted(engine) if isinstance(t, OnSites) else engine
    room, (kernel, arguments) = engine.shares, (_rows if isinstance(t, PairRowsTerm) else _clusters)(seen, t, energies, virials)
    calls = [bound(kernel, (*arguments(tid), room.front[tid], room.back[tid])) for tid in range(engine.threads)]
    engine.parallel(lambda tid: calls[tid]())
    scale = 0.5 * (1.0 if t.owner.is_plain else float(t.owner.use.factor))
    column = -1 if not energies else 0 if isinstance(t, PairTerm) and not virials else 3
    by_row.of_tables(engine.slot_of, room.front, room.back, scale, column, virials, energy, virial)
    if isinstance(t, PairRowsTerm) and not virials:
        room.back[:] = 0.0


def _clusters(engine: Engine, t: PairTerm, energies: bool, virials: bool):
    """The kernel of a term over clusters, and its arguments by thread."""
    s, c = engine.state, t.clusters(engine)
    rows = 15 + 2 * pair_kernels.buffer_rows(len(t.uniform) - sum(t.uniform))
    if t.share_room is None or t.share_room[0].shape[1] < rows * t.row:
        t.share_room = aligned((engine.threads, -(-rows * t.row // 8) * 8)), np.zeros((engine.threads, t.row))
    buffers, saved = t.share_room
    p = pair_kernels.cluster_tuple(t.tables.rows, t.tables.constants, t.uniform, False)
    coefficients = pair_kernels.varying_rows(t.tables.rows, t.uniform)

    def arguments(tid):
        return (s.x, s.q, s.type, c.first[tid], c.entries[tid], c.own, c.span, c.unshifted, c.shifts4, c.excluded_first[tid],
                c.excluded[tid], int(c.bounds[tid]), int(c.bounds[tid + 1]), p, coefficients, 1e3 * c.reach, engine.qqr2e,
                buffers[tid], t.types[tid], saved[tid], t.tables4[tid, 0], c.hide[tid], engine.settings.skin, engine.moved,
                engine.farthest[tid:tid + 1])
    kernel = pair_kernels.shares_kernel(t.style, t.uniform, t.row, energies=energies, virials=virials, exclude=t.exclude,
                                        outdated=t.outdated)
    return kernel, arguments


def _rows(engine: Engine, t: PairRowsTerm, energies: bool, virials: bool):
    """The same over rows of single atoms."""
    s, c, rows = engine.state, engine.list, engine.rows[t.owner.molecules]

    def arguments(tid):
        return (s.x, s.q, s.type, rows.start[tid], rows.neighbors[tid], c.shifts, CLUSTER * int(c.bounds[tid]),
                CLUSTER * int(c.bounds[tid + 1]), t.p, t.tables.rows, t.tables.arrays, engine.qqr2e)
    return pair_kernels.rows_kernel(t.style, t.uniform, energy=True, shares=True)[0], arguments


def _of_others(engine: Engine, t, energies: bool, virials: bool, energy: np.ndarray, virial: np.ndarray) -> None:
    """Other terms give forces with the shares, into arrays that stand in for those of the engine meanwhile."""
    kept = engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial
    engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial = engine.shares.columns(engine)
    try:
        if isinstance(t, EmbeddedTerm):
            t, index, engine.listed = ManyBodyTerm(t.owner), t.index, None
            t.index = index
            t.rebuild(engine)
        f, many = t.kernel(True, True), isinstance(t, ManyBodyTerm)
        apart = {"shares": True} if many or isinstance(t, NoiseTerm) else {}
        given = [t.arguments(engine, tid, **apart) for tid in range(engine.threads)]
        calls = [bound(f, arguments, 2) for arguments in given]
        engine.parallel(lambda tid: calls[tid]())
        scale = float(t.owner.use.factor) if many else 1.0
        by_row.of_columns(engine.slot_of, engine.atom_energy, engine.atom_virial, scale, energy, virial)
    finally:
        engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial = kept
