"""Atoms that leave a running simulation: system, groups, exclusions, lists and the arrays of fixes follow."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import SimulationError

if TYPE_CHECKING:
    from asemd.fix import Fix
    from asemd.loop import Loop


def remove(loop: Loop, rows) -> None:
    """Take atoms out of the system in the midst of a run: system, groups, exclusions, lists and the fixes' arrays by atom.

    Raises
    ------
    SimulationError
        An atom is bonded to one that stays, unless ``settings.lost_bond`` says otherwise.
    """
    e, system, s = loop.engine, loop.system, loop.settings
    gone = np.zeros(system.n, bool)
    gone[rows] = True
    for kind, atoms, _ in system.topology:
        torn = np.flatnonzero(gone[atoms].any(axis=1) & ~gone[atoms].all(axis=1)) if len(atoms) else ()
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
    e.set_groups(loop.groups, e.bits)
    e.update(system)
    e.load()
    loop.fix_data = tuple(_resize(loop, fix, *data, gone) for fix, data in zip(loop.fixes, loop.fix_data))


def _resize(loop: Loop, fix: Fix, p: np.ndarray, old, gone: np.ndarray) -> tuple:
    """The arrays of a fix for the atoms that stay."""
    a = loop.arrays_of(fix)
    if isinstance(a, np.ndarray) and len(old) == len(gone):
        a[:] = old[~gone]
    fix.resize(loop)
    return p, a
