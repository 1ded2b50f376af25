"""Each atom's share of energy and virial, from kernels that are run for it."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.embedded_term import EmbeddedTerm
from asemd.manybody_term import ManyBodyTerm
from asemd.result import Result
from asemd.term import PairListTerm, PairRowsTerm, PairTerm

if TYPE_CHECKING:
    from asemd.engine import Engine


def add(engine: Engine, result: Result) -> Result:
    """Add `energies`, `virials` and their parts by category to the result of the engine's last evaluation.

    The kernels for shares write energies and forces again, so these are put back as they were.
    """
    n, capacity = engine.system.n, engine.state.x.shape[1]
    if engine.mode == "cluster" and not engine.expanded:
        engine.mark(*engine.list.expand(engine.k, engine.state, engine.cutoff), engine.list.shifts)
    keep = (engine.acc.copy(), engine.buffers.copy())
    engine.atom_energy, engine.atom_virial = np.zeros((engine.threads, capacity)), np.zeros((engine.threads, 6, capacity))
    rows, slots = engine.state.row[:engine.ns], np.flatnonzero(engine.state.row[:engine.ns] >= 0)
    for t in engine.terms:
        if isinstance(t, PairListTerm) and t.pairs == "special":
            continue
        if isinstance(t, (PairTerm, PairRowsTerm)):
            t, index = PairListTerm(t.style, t.tables, t.style.parts, "all", owner=t.owner), t.index
            t.index = index
            t.rebuild(engine)
        elif isinstance(t, EmbeddedTerm):
            t, index, engine.listed = ManyBodyTerm(t.owner), t.index, None
            t.index = index
            t.rebuild(engine)
        engine.atom_energy[:] = 0.0
        engine.atom_virial[:] = 0.0
        f, many = t.kernel(True, True), isinstance(t, ManyBodyTerm)
        given = [t.arguments(engine, tid, shares=True) if many else t.arguments(engine, tid) for tid in range(engine.threads)]
        engine.parallel(lambda tid, f=f, given=given: f(*given[tid]))
        e, v = np.zeros(n), np.zeros((n, 6))
        e[rows[slots]] = engine.atom_energy.sum(0)[slots]
        v[rows[slots]] = engine.atom_virial.sum(0)[:, slots].T
        if many:
            e, v = t.owner.use.factor * e, t.owner.use.factor * v
        result.energies_of[t.category] = result.energies_of.get(t.category, 0.0) + e
        result.virials_of[t.category] = result.virials_of.get(t.category, 0.0) + v
    engine.acc[:], engine.buffers[:] = keep
    engine.atom_energy, engine.atom_virial = np.zeros((engine.threads, 1)), np.zeros((engine.threads, 6, 1))
    engine.thread_arguments = None
    result.energies = sum(result.energies_of.values(), np.zeros(n))
    result.virials = sum(result.virials_of.values(), np.zeros((n, 6)))
    return result
