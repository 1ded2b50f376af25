"""Bonded items that lost atoms but are still listed with those that stayed, as LAMMPS keeps them: ``delete_atoms`` without ``bond yes``.

They are entries (kind, type, ids) of `asemd.system.System.torn`; they have no energy.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import SimulationError
from asemd.topology import CROSSTERM


def left(system, gone: np.ndarray, newton: bool, delete: bool) -> list[tuple[str, int, tuple[int, ...]]]:
    """Items that stay listed though some of their atoms are gone, old and new ones: those whose list is with an atom that stays.

    That is the first atom of a bond and the second one of other items, or without newton any atom; any atom of a cross term. With `delete`
    the new ones go, but for cross terms.
    """
    away, here = set(system.id[gone].tolist()), set(system.id[~gone].tolist())
    out = [(kind, int(t), tuple(system.id[atoms[m]].tolist())) for kind, atoms, types in system.topology.every()
           if len(atoms) and not (delete and kind != CROSSTERM) for m, t in enumerate(types.tolist()) if gone[atoms[m]].any()]
    out += [item for item in system.torn if item[0] == CROSSTERM or not (delete and away.intersection(item[2]))]
    return [(kind, t, ids) for kind, t, ids in out
            if ((ids[0] if kind == "bond" else ids[1]) in here if newton and kind != CROSSTERM else here.intersection(ids))]


def counts(system) -> dict[str, int]:
    """Items by kind, those that lack atoms too."""
    return {kind: n + sum(item[0] == kind for item in system.torn) for kind, n in system.topology.counts().items()}


def check(session) -> None:
    """Refuse bonded items that lack atoms, or warn of them, as ``thermo_modify lost/bond`` says; they have no energy.

    Raises
    ------
    SimulationError
        The message names the atoms.
    """
    items_of_all = [item for item in session.scene.system.torn if item[1] > 0 and item[0] != CROSSTERM]      # of these fix cmap knows
    how = session.scene.thermo.lost_bond
    for kind in dict.fromkeys(item[0] for item in items_of_all) if how != "ignore" else ():
        items = [item for item in items_of_all if item[0] == kind]
        text = f"{kind.capitalize()} atoms {' '.join(map(str, items[0][2]))} missing: {len(items)} {kind}s lack atoms"
        if how == "error":
            raise SimulationError(f"{text}; use bond yes or mol yes in delete_atoms, or thermo_modify lost/bond ignore or warn")
        session.warn(text)
