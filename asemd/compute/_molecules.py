"""Molecules as chunks: what the older computes of molecules sum over."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError


class Molecules:
    """The molecules with atoms in a group, in ascending order of their ids.

    Parameters
    ----------
    group : str
    """

    needs: frozenset[str] = frozenset()

    def __init__(self, group: str):
        self.group = group

    def ids(self, state) -> np.ndarray:
        """Molecule ids."""
        return np.unique(state.system.molecule[state.mask(self.group)])

    def assign(self, state) -> tuple[np.ndarray, int]:
        """(n,) number of the molecule of each atom of the group from 1 on, 0 for none; and how many there are."""
        ids = self.ids(state)
        return np.where(state.mask(self.group), np.searchsorted(ids, state.system.molecule) + 1, 0), len(ids)


def start(compute: Compute, session) -> SimpleNamespace:
    """The state in which a compute of molecules is made; warns of molecules that are not whole.

    Raises
    ------
    InputError
        Atoms without molecules.
    """
    what = f"compute {compute.style}"
    system, mask = session.scene.need_system(what), session.scene.groups.mask(compute.group)
    if not system.molecular:
        raise InputError(f"{what}: atom style {system.atom_style} has no molecules")
    if np.isin(system.molecule[~mask], system.molecule[mask]).any():
        session.warn(f"{what}: one or more molecules have atoms that are not in group {compute.group}")
    if (system.molecule[mask] == 0).any():
        session.warn(f"{what}: atoms with molecule id 0 in group {compute.group} are taken for a molecule")
    return SimpleNamespace(system=system, mask=session.scene.groups.mask)
