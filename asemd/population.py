"""Atoms that leave or join a running simulation: system, groups, exclusions, lists and the arrays of fixes follow."""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from asemd import turnover
from asemd.errors import InputError, SimulationError
from asemd.kernels.rows import of_slots
from asemd.kspace.term import count
from asemd.topology import CROSSTERM

if TYPE_CHECKING:
    from asemd.loop import Loop
    from asemd.system import System

IN_SLOTS = ("x", "v", "f")


def remove(loop: Loop, rows, lost: bool = True, listed: bool = True) -> None:
    """Take atoms out of the system in the midst of a run: system, groups, exclusions, lists and the fixes' arrays by atom.

    Positions, velocities and forces of the system are those of the loop only after its next `sync_out`.

    Parameters
    ----------
    rows : array of int
    lost : bool
        They left through a face of the box, which ``thermo_modify lost`` tells; else a fix takes them out on purpose.
    listed : bool
        Whether a list is made at once; False before the step's own, in a hook `pre_exchange`.

    Raises
    ------
    SimulationError
        An atom is bonded to one that stays, unless ``settings.lost_bond`` says otherwise.
    """
    _change(loop, rows, None, (), lost, listed)


def insert(loop: Loop, atoms: System, groups: Iterable[str] | Mapping[str, np.ndarray] = (), listed: bool = True) -> None:
    """Let atoms join in the midst of a run, behind those that are there, with the ids they have.

    Parameters
    ----------
    atoms : System
        In the same units; topology items among themselves.
    groups : iterable of str, or mapping of str to (n,) bool
        The groups they belong to besides ``all``; the mapping says which of them.
    listed : bool
        As for `remove`.

    Raises
    ------
    InputError
        An id that exists.
    """
    _change(loop, (), atoms, groups, False, listed)


def exchange(loop: Loop, rows, atoms: System, groups: Iterable[str] | Mapping[str, np.ndarray] = ()) -> None:
    """Atoms go, as by `remove` on purpose, and others join, as by `insert`; in a hook `pre_exchange`, for a list follows."""
    _change(loop, rows, atoms, groups, False, False)


def places(loop: Loop) -> np.ndarray:
    """Where the atoms are in the midst of a run, (n, 3)."""
    x = np.empty((loop.system.n, 3), order="F")
    of_slots(loop.engine.slot_of, loop.state.x, x)
    return x


def _change(loop: Loop, rows, atoms: System | None, groups, lost: bool, listed: bool) -> None:
    """Atoms go, others join."""
    e, n = loop.engine, loop.system.n
    rows = np.asarray(rows, np.int64)
    if len(rows) > 1:
        rows = np.unique(rows)
    simple = turnover.simple(e, rows, atoms)
    if not simple or e.mode != "cluster":
        e.store()
    gone = np.zeros(n, bool)
    gone[rows] = True
    slotted = IN_SLOTS if simple and e.mode == "cluster" else ()
    if len(rows):
        _take_out(loop, rows, gone, lost, slotted)
    if atoms is not None:
        _put_in(loop, atoms, groups, simple, slotted)
    e.groups = dict(loop.groups)
    if simple:
        turnover.follow(e, rows, loop.system.n - (n - len(rows)))
        if listed:
            e.rebuild()
    else:
        e.update(loop.system, e.solver)
        e.load(listed)
    _resize(loop, (lambda old, new: old[~gone] if len(old) == n else new) if atoms is None else _joined(gone))


def _joined(gone: np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Old numbers of the atoms that stayed before the new ones."""
    left = int(np.count_nonzero(~gone))

    def joined(old, new):
        if len(old) == len(gone) and new.shape[1:] == old.shape[1:]:
            new[:left] = old[~gone]
        return new
    return joined


def _take_out(loop: Loop, rows: np.ndarray, gone: np.ndarray, lost: bool, slotted: Collection[str]) -> None:
    """The system, groups and exclusions without some atoms."""
    system, s = loop.system, loop.settings
    for kind, atoms, _ in () if system.topology.is_empty else system.topology.every():
        torn = np.flatnonzero(gone[atoms].any(axis=1) & ~gone[atoms].all(axis=1)) if len(atoms) else ()
        if len(torn) and kind == CROSSTERM:
            raise SimulationError(f"CMAP atoms {' '.join(str(i) for i in system.id[atoms[torn[0]]])} missing: one of them left the system")
        if len(torn) and s.lost_bond == "error":
            ids = " ".join(str(i) for i in system.id[atoms[torn[0]]])
            raise SimulationError(f"{kind} atoms {ids} missing: one of them left the box; use thermo_modify lost/bond ignore or warn "
                                  "to go on without them")
        if len(torn) and s.lost_bond == "warn":
            loop.warn(f"step {loop.step}: {len(torn)} {kind}{'s' * (len(torn) > 1)} lost with an atom")
    _drop(system, rows, gone, slotted)
    for name, mask in loop.groups.items():
        loop.gone[name] = loop.gone.get(name, 0) + int(np.count_nonzero(mask[rows]))
        loop.groups[name] = turnover.changed(mask, rows)
    s.exclude = [(kind, *(m if kind == "type" else turnover.changed(m, rows) for m in masks)) for kind, *masks in s.exclude]
    if not lost:
        loop.natoms -= len(rows)


def _drop(system: System, rows: np.ndarray, gone: np.ndarray, slotted: Collection[str]) -> None:
    """The system without some atoms, in place, so that whoever holds it sees it; bonded items that lose an atom go.

    What is `slotted` comes from the slots anyway before anybody reads it.
    """
    top = system.topology
    if not top.is_empty:
        if top.frozen is None and not any(gone[atoms].any() for _, atoms, _ in top.every()):
            top.rename(np.cumsum(~gone) - 1)
        else:
            system.topology = top.select(~gone, system.n)
    left = len(gone) - len(rows)
    _take(system, {name: a[:left] if name in slotted else turnover.changed(a, rows) for name, a in system.per_atom().items()})


def _join(system: System, atoms: System, alike: bool, slotted: Collection[str]) -> None:
    """`System.append`, with the ids that the atoms have, in place; `alike`: surely of the same properties and types."""
    if alike or turnover.alike(system, atoms):
        if atoms.n and atoms.id.min() <= system.id.max(initial=0) and np.isin(atoms.id, system.id).any():
            raise InputError(f"atom ID {atoms.id[np.isin(atoms.id, system.id)][0]} exists in both systems")
        theirs = atoms.per_atom()
        _take(system, {name: _behind(a, theirs[name], name in slotted) for name, a in system.per_atom().items()})
    else:
        system.__dict__.update(system.append(atoms, keep_ids=True).__dict__)


def _behind(array: np.ndarray, more: np.ndarray, slotted: bool) -> np.ndarray:
    """An array with more rows behind it; if it is in slots, only these rows matter."""
    if not slotted:
        return np.concatenate([array, more])
    out = np.empty((len(array) + len(more), *array.shape[1:]))
    out[len(array):] = more
    return out


def _take(system: System, arrays: Mapping[str, np.ndarray]) -> None:
    """Other per-atom arrays, all of them."""
    for name, array in arrays.items():
        if name in system.extra:
            system.extra[name] = array
        else:
            setattr(system, name, array)


def _put_in(loop: Loop, atoms: System, groups: Iterable[str] | Mapping[str, np.ndarray], alike: bool,
            slotted: Collection[str]) -> None:
    """The system, groups and exclusions with more atoms."""
    system, s, n = loop.system, loop.settings, atoms.n
    everybody, nobody = np.ones(n, bool), np.zeros(n, bool)
    chosen = groups if isinstance(groups, Mapping) else dict.fromkeys(groups, everybody)
    joins = {name: everybody if name == "all" else np.asarray(chosen.get(name, nobody), bool) for name in loop.groups}
    _join(system, atoms, alike, slotted)

    def longer(mask):       # exclusions hold masks, no names of groups: that of a group beside `all`, where one fits
        join = np.zeros(n, bool)
        same = [name for name in joins if np.array_equal(loop.groups[name], mask)]
        for name in [name for name in same if name != "all"] or same:
            join |= joins[name]
        for name, which in joins.items():
            if np.array_equal(loop.groups[name], ~mask):
                join |= ~which
        return np.append(mask, join)
    s.exclude = [(kind, *(m if kind == "type" else longer(m) for m in masks)) for kind, *masks in s.exclude]
    for name, which in joins.items():
        loop.groups[name] = np.concatenate([loop.groups[name], which])
        loop.gone[name] = loop.gone.get(name, 0) - int(np.count_nonzero(which))
    loop.natoms += n


def recharge(loop: Loop) -> None:
    """Go on after charges of the system were changed, with the list, terms and parameters of solvers that there are."""
    e = loop.engine
    e.q_row[:] = e.state.q[e.slot_of] = loop.system.q
    e.varies[2] = True
    count(e)


def retie(loop: Loop, afresh: bool = False) -> None:
    """Go on after bonds, types or charges of the system were changed; `afresh`: after coefficients were, which solvers depend on."""
    e = loop.engine
    e.store()
    e.groups = dict(loop.groups)
    e.update(loop.system, None if afresh else e.solver)
    e.load()
    _resize(loop, lambda old, new: old if old.shape == new.shape else new)


def _resize(loop: Loop, keep: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> None:
    """The arrays of the fixes for the atoms there are now; `keep` says what becomes of the old numbers by atom."""
    data = []
    for fix, (p, old) in zip(loop.fixes, loop.fix_data):
        a = loop.arrays_of(fix)
        if isinstance(a, np.ndarray) and isinstance(old, np.ndarray):
            if a.shape != (1, 1):
                a[:] = keep(old, a)
            elif old.shape == (1, 1):
                a = old         # which is packed in memory
        fix.resize(loop)
        data.append((p, a))
    loop.fix_data = tuple(data)
