"""Charges on massless sites of water molecules (TIP4P): where the sites are.

The charge of an oxygen atom is at M, on the bisector of the angle H-O-H: x_M = x_O + a/2 [(x_H1 - x_O) + (x_H2 - x_O)]. The hydrogen atoms
are those whose ids follow that of the oxygen atom. Forces on M are shared by the three atoms, (1 - a), a/2 and a/2, and so are energies and
virials where each atom's part is asked for.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asemd.errors import InputError


@dataclass(frozen=True)
class ChargeSites:
    """Which atoms have their charges on sites.

    Attributes
    ----------
    oxygen, hydrogen : int
        Types of atoms.
    share : float
        What the hydrogen atoms together have of a site.
    name : str
        The pair style, for messages.
    """

    oxygen: int
    hydrogen: int
    share: float
    name: str

    def atoms(self, system) -> np.ndarray:
        """Rows (m, 3) of oxygen and hydrogen atoms of all sites.

        Raises
        ------
        InputError
            An oxygen atom whose hydrogen atoms are not there, are of another type, or are not those that it has bonds to.
        """
        oxygen = np.flatnonzero(np.asarray(system.type) == self.oxygen)
        ids = np.asarray(system.id)
        order = np.argsort(ids, kind="stable")
        wanted = ids[oxygen][:, None] + np.array([1, 2])
        at = np.minimum(np.searchsorted(ids[order], wanted), max(len(ids) - 1, 0))
        rows = order[at]
        missing = np.argwhere(ids[rows] != wanted)
        if len(missing):
            raise InputError(f"pair style {self.name}: TIP4P hydrogen is missing: oxygen atom {ids[oxygen[missing[0][0]]]} needs hydrogen "
                             f"atom {wanted[tuple(missing[0])]}, there is none; ids of a molecule must be in the order O H H")
        wrong = np.argwhere(np.asarray(system.type)[rows] != self.hydrogen)
        if len(wrong):
            raise InputError(f"pair style {self.name}: TIP4P hydrogen has incorrect atom type: atom {wanted[tuple(wrong[0])]} of oxygen "
                             f"atom {ids[oxygen[wrong[0][0]]]} has not type {self.hydrogen}; ids of a molecule must be in the order O H H")
        n, bonds = len(ids), np.sort(system.topology.bonds.astype(np.int64), axis=1)
        pairs = np.sort(np.stack([np.broadcast_to(oxygen[:, None], rows.shape), rows], axis=-1), axis=-1)
        apart = ~np.isin(pairs[..., 0] * n + pairs[..., 1], bonds[:, 0] * n + bonds[:, 1]).all(axis=1) & np.isin(oxygen, bonds)
        if apart.any():
            k = int(np.argmax(apart))
            raise InputError(f"pair style {self.name}: atoms {wanted[k, 0]} and {wanted[k, 1]} behind oxygen atom {ids[oxygen[k]]} are "
                             "not those bonded to it; ids of a molecule must be in the order O H H")
        return np.column_stack([oxygen, rows])
