"""Atoms that leave or join a running simulation: system, groups, exclusions, lists and the arrays of fixes follow."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import SimulationError
from asemd.topology import CROSSTERM

if TYPE_CHECKING:
    from asemd.fix import Fix
    from asemd.loop import Loop
    from asemd.system import System


def remove(loop: Loop, rows, lost: bool = True) -> None:
    """Take atoms out of the system in the midst of a run: system, groups, exclusions, lists and the fixes' arrays by atom.

    Parameters
    ----------
    rows : array of int
    lost : bool
        They left through a face of the box, which ``thermo_modify lost`` tells; else a fix takes them out on purpose.

    Raises
    ------
    SimulationError
        An atom is bonded to one that stays, unless ``settings.lost_bond`` says otherwise.
    """
    e, system, s = loop.engine, loop.system, loop.settings
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
    e.store()
    system.keep(~gone)
    for name in loop.groups:
        loop.gone[name] = loop.gone.get(name, 0) + int(np.count_nonzero(loop.groups[name] & gone))
        loop.groups[name] = loop.groups[name][~gone]
    s.exclude = [(kind, *(m if kind == "type" else m[~gone] for m in masks)) for kind, *masks in s.exclude]
    if not lost:
        loop.natoms -= int(np.count_nonzero(gone))
    _go_on(loop, lambda old, new: old[~gone] if len(old) == len(gone) else new)


def insert(loop: Loop, atoms: System, groups: Iterable[str] = ()) -> None:
    """Let atoms join in the midst of a run, behind those that are there, with the ids they have.

    Parameters
    ----------
    atoms : System
        In the same units; topology items among themselves.
    groups : iterable of str
        The groups they belong to besides ``all``.

    Raises
    ------
    InputError
        An id that exists.
    """
    e, system, s, n = loop.engine, loop.system, loop.settings, atoms.n
    e.store()
    before, joins = system.n, {"all", *groups}
    system.__dict__.update(system.append(atoms, keep_ids=True).__dict__)

    def longer(mask):       # exclusions hold masks, no names of groups
        same = [name in joins for name in loop.groups if np.array_equal(loop.groups[name], mask)]
        other = [name not in joins for name in loop.groups if np.array_equal(loop.groups[name], ~mask)]
        return np.append(mask, np.full(n, any(same or other)))
    s.exclude = [(kind, *(m if kind == "type" else longer(m) for m in masks)) for kind, *masks in s.exclude]
    for name in loop.groups:
        loop.groups[name] = np.append(loop.groups[name], np.full(n, name in joins))
        loop.gone[name] = loop.gone.get(name, 0) - n * (name in joins)
    loop.natoms += n

    def joined(old, new):
        if len(old) == before and new.shape[1:] == old.shape[1:]:
            new[:before] = old
        return new
    _go_on(loop, joined)


def retie(loop: Loop) -> None:
    """Go on after bonds, types or charges of the system were changed."""
    loop.engine.store()
    _go_on(loop, lambda old, new: old if old.shape == new.shape else new)


def _go_on(loop: Loop, keep: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> None:
    """Lists and arrays of fixes for the system as it is now; `keep` says what becomes of the old numbers by atom."""
    e = loop.engine
    e.set_groups(loop.groups, e.bits)
    e.update(loop.system)
    e.load()
    loop.fix_data = tuple(_resize(loop, fix, p, old, keep) for fix, (p, old) in zip(loop.fixes, loop.fix_data))


def _resize(loop: Loop, fix: Fix, p: np.ndarray, old, keep) -> tuple:
    """The arrays of a fix for the atoms there are now."""
    a = loop.arrays_of(fix)
    if isinstance(a, np.ndarray) and isinstance(old, np.ndarray) and a.shape != (1, 1):
        a[:] = keep(old, a)
    fix.resize(loop)
    return p, a
