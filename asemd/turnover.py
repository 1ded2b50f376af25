"""Atoms without bonds that leave or join: slots, masks and terms of an engine follow, instead of being made anew."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.neighbor import SMALL

if TYPE_CHECKING:
    from asemd.engine import Engine
    from asemd.system import System


FEW = 8         # rows


def simple(engine: Engine, gone: np.ndarray, atoms: System | None) -> bool:
    """Whether `follow` can do it, before the system changes.

    Parameters
    ----------
    engine : asemd.engine.Engine
    gone : array of int
        Rows that leave: of no bonded item.
    atoms : asemd.system.System or None
        What joins: without bonded items, of the same style and types.
    """
    system, exclusions, more = engine.system, engine.exclusions, 0 if atoms is None else atoms.n
    engine.bonds.carry_back()
    if engine.expanded or engine.bonds.pending or engine.solver is not None or engine.many_terms:
        return False
    if any(np.ndim(t.use.factor) > 0 or t.style.sized for t in engine.pair_terms):
        return False
    if engine.mode == "cluster" and engine.ns + more + 8 > engine.state.x.shape[1]:
        return False
    if not _keeps_list(engine, system.n - len(gone) + more):
        return False
    if atoms is not None and not alike(system, atoms):
        return False
    top = system.topology
    if top.is_empty or not len(gone):
        return True
    leaves = np.zeros(system.n, bool)
    leaves[gone] = True
    partners = exclusions.partners is not None and (exclusions.partners[0][gone + 1] != exclusions.partners[0][gone]).any()
    return top.frozen is None and not partners and not any(leaves[atoms].any() for _, atoms, _ in top.every())


def _keeps_list(engine: Engine, n: int) -> bool:
    """Whether `n` atoms need the neighbour list that the present ones have."""
    now = engine.system.n
    if engine.box_moves:
        return engine.list_for(n)[:3] == (engine.mode, engine.expanded, engine.sparse)
    return (n < SMALL) == (now < SMALL) and engine.few(n) == engine.few(now)


def alike(system: System, atoms: System) -> bool:
    """Whether atoms have the properties and types of a system and no bonded items."""
    mine, theirs = system.per_atom(), atoms.per_atom()
    if atoms.units != system.units or not atoms.topology.is_empty or mine.keys() != theirs.keys():
        return False
    unset = np.isnan(system.mass[:len(atoms.mass)])
    return (all(system.counts[k] >= v for k, v in atoms.counts.items()) and not np.isfinite(atoms.mass[:len(unset)][unset]).any()
            and all(mine[k].shape[1:] == theirs[k].shape[1:] for k in mine))


def follow(engine: Engine, gone: np.ndarray, more: int) -> None:
    """Take over that rows `gone` have left the engine's system and `more` atoms joined behind; a list must be built next."""
    s, slots, before = engine.state, engine.ns, len(engine.slot_of)
    engine.exclusions.follow(engine.system, engine.settings.exclude, gone, more)
    if len(gone):
        new = np.arange(before + 1, dtype=np.int32)
        for row in gone[::-1].tolist() if len(gone) <= FEW else ():
            new[row:] -= np.int32(1)
        if len(gone) > FEW:
            new -= np.searchsorted(gone, new).astype(np.int32)
        new[gone] = new[-1] = -1        # the last one is that of an empty slot, whose row is -1
        for term in engine.terms:
            term.rename(new)
        s.row[:slots] = new[s.row[:slots]]
    _put_in(engine, gone, more)
    _constants(engine, gone, more)
    if engine.mode != "cluster":        # whose slots are the rows
        engine.load(False)
    engine.state = engine.state._replace(slot=engine.slot_of, image=engine.system.image)
    engine.thread_arguments = None


def _put_in(engine: Engine, gone: np.ndarray, more: int) -> None:
    """Slots for the last atoms of the system, behind the others."""
    system, s, slots = engine.system, engine.state, engine.ns
    if engine.mode != "cluster":
        engine.slot_of = np.zeros(system.n, np.int32)
        return
    new = slice(slots, slots + more)
    engine.slot_of = changed(engine.slot_of, gone, np.arange(slots, slots + more, dtype=np.int32))
    if more:
        s.row[new] = np.arange(system.n - more, system.n)
        s.x[:, new], s.v[:, new] = system.x[-more:].T, system.v[-more:].T
        s.f[:, new], s.torque[:, new], engine.held[:, new] = 0.0, 0.0, s.x[:, new]
    engine.ns, engine._offset = slots + more, None


def _constants(engine: Engine, gone: np.ndarray, more: int) -> None:
    """Types, masses, charges and masks by row."""
    system, last = engine.system, slice(engine.system.n - more, None)
    names, own = ("mass_row", "inverse_row", "mask_row"), ((), (), ())
    if more:
        mass = system.rmass[last] if system.rmass is not None else system.mass[system.type[last]]
        mass = np.where(np.isnan(mass), 1.0, mass)
        mask = np.ones(more, np.int32)
        for name, members in engine.groups.items():
            mask[members[last]] |= np.int32(engine.bits[name])
        own = (mass,), (engine.units.ftm2v / mass,), (mask,)
    for name, values in zip(names, own):
        setattr(engine, name, changed(getattr(engine, name), gone, *values))
    engine.type_row = np.ascontiguousarray(system.type, np.int32)
    engine.q_row = np.ascontiguousarray(system.q, float) if system.q is not None else np.zeros(system.n)
    if more:
        for k, array in enumerate((engine.type_row, engine.mass_row, engine.q_row, engine.mask_row)):
            engine.varies[k] |= bool((array[last] != array[0]).any())


def changed(array: np.ndarray, gone: np.ndarray, *joining: np.ndarray) -> np.ndarray:
    """An array without some rows, which are in order, and with others behind; of the same type."""
    if len(gone) > FEW:
        array, gone = np.delete(array, gone, axis=0), gone[:0]
    edges = gone.tolist()       # between them memory is copied in one piece
    pieces = [array[a:b] for a, b in zip([0, *(k + 1 for k in edges)], [*edges, len(array)])]
    return np.concatenate([*pieces, *joining], dtype=array.dtype)
