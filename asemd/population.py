"""Atoms that leave or join a running simulation: system, groups, exclusions, lists and the arrays of fixes follow."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import SimulationError
from asemd.topology import CROSSTERM

if TYPE_CHECKING:
    from asemd.fix import Fix
    from asemd.loop import Loop
    from asemd.system import System


def remove(loop: Loop, rows, lost: bool = True, listed: bool = True) -> None:
    """Take atoms out of the system in the midst of a run: system, groups, exclusions, lists and the fixes' arrays by atom.

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
    loop.engine.store()
    gone = _take_out(loop, rows, lost)
    _go_on(loop, lambda old, new: old[~gone] if len(old) == len(gone) else new, listed)


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
    loop.engine.store()
    before = loop.system.n
    _put_in(loop, atoms, groups)
    _go_on(loop, _joined(np.zeros(before, bool)), listed)


def exchange(loop: Loop, rows, atoms: System, groups: Iterable[str] | Mapping[str, np.ndarray] = ()) -> None:
    """Atoms go, as by `remove` on purpose, and others join, as by `insert`; in a hook `pre_exchange`, for a list follows."""
    loop.engine.store()
    gone = _take_out(loop, rows, False)
    _put_in(loop, atoms, groups)
    _go_on(loop, _joined(gone), False)


def _joined(gone: np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Old numbers of the atoms that stayed before the new ones."""
    left = int(np.count_nonzero(~gone))

    def joined(old, new):
        if len(old) == len(gone) and new.shape[1:] == old.shape[1:]:
            new[:left] = old[~gone]
        return new
    return joined


def _take_out(loop: Loop, rows, lost: bool) -> np.ndarray:
    """The system, groups and exclusions without some atoms; (n,) bool which of those that were there are gone."""
    system, s = loop.system, loop.settings
    gone = np.zeros(system.n, bool)
    gone[rows] = True
    for kind, atoms, _ in system.topology.every():
        torn = np.flatnonzero(gone[atoms].any(axis=1) & ~gone[atoms].all(axis=1)) if len(atoms) else ()
        if len(torn) and kind == CROSSTERM:
            raise SimulationError(f"CMAP atoms {' '.join(str(i) for i in system.id[atoms[torn[0]]])} missing: one of them left the system")
        if len(torn) and s.lost_bond == "error":
            ids = " ".join(str(i) for i in system.id[atoms[torn[0]]])
            raise SimulationError(f"{kind} atoms {ids} missing: one of them left the box; use thermo_modify lost/bond ignore or warn "
                                  "to go on without them")
        if len(torn) and s.lost_bond == "warn":
            loop.warn(f"step {loop.step}: {len(torn)} {kind}{'s' * (len(torn) > 1)} lost with an atom")
    system.keep(~gone)
    for name in loop.groups:
        loop.gone[name] = loop.gone.get(name, 0) + int(np.count_nonzero(loop.groups[name] & gone))
        loop.groups[name] = loop.groups[name][~gone]
    s.exclude = [(kind, *(m if kind == "type" else m[~gone] for m in masks)) for kind, *masks in s.exclude]
    if not lost:
        loop.natoms -= int(np.count_nonzero(gone))
    return gone


def _put_in(loop: Loop, atoms: System, groups: Iterable[str] | Mapping[str, np.ndarray]) -> None:
    """The system, groups and exclusions with more atoms."""
    system, s, n = loop.system, loop.settings, atoms.n
    chosen = groups if isinstance(groups, Mapping) else dict.fromkeys(groups, np.ones(n, bool))
    joins = {name: np.ones(n, bool) if name == "all" else np.asarray(chosen.get(name, np.zeros(n, bool)), bool) for name in loop.groups}
    system.__dict__.update(system.append(atoms, keep_ids=True).__dict__)

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
        loop.groups[name] = np.append(loop.groups[name], which)
        loop.gone[name] = loop.gone.get(name, 0) - int(np.count_nonzero(which))
    loop.natoms += n


def retie(loop: Loop) -> None:
    """Go on after bonds, types or charges of the system were changed."""
    loop.engine.store()
    _go_on(loop, lambda old, new: old if old.shape == new.shape else new)


def _go_on(loop: Loop, keep: Callable[[np.ndarray, np.ndarray], np.ndarray], listed: bool = True) -> None:
    """Lists and arrays of fixes for the system as it is now; `keep` says what becomes of the old numbers by atom."""
    e = loop.engine
    e.set_groups(loop.groups, e.bits)
    e.update(loop.system)
    e.load(listed)
    loop.fix_data = tuple(_resize(loop, fix, p, old, keep) for fix, (p, old) in zip(loop.fixes, loop.fix_data))


def _resize(loop: Loop, fix: Fix, p: np.ndarray, old, keep) -> tuple:
    """The arrays of a fix for the atoms there are now."""
    a = loop.arrays_of(fix)
    if isinstance(a, np.ndarray) and isinstance(old, np.ndarray) and a.shape != (1, 1):
        a[:] = keep(old, a)
    fix.resize(loop)
    return p, a
