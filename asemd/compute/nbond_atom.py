r"""Number of bonds of each atom; broken and turned-off bonds are none.

Source: LAMMPS manual, compute nbond/atom. Units: none. Words: ``bond/type N``: only bonds of that type.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError, nearest
from asemd.words import take, whole


class NBondAtom(Compute):
    """Bonds of each atom.

    Parameters
    ----------
    group : str
        The atoms it reports; bonds to others count.
    bond_type : int, optional
        Only bonds of this type; None: all.
    """

    style = "nbond/atom"

    def __init__(self, group: str = "all", bond_type: int | None = None):
        super().__init__(group)
        self.bond_type = bond_type

    @classmethod
    def from_lammps(cls, group, words, session):
        what, rest, bond_type = "compute nbond/atom", list(words), None
        if not session.scene.need_system(what).molecular:
            raise InputError(f"{what} needs atoms with bonds, such as atom_style bond")
        while rest:
            if rest[0] != "bond/type":
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], ['bond/type'])}")
            bond_type = whole(take(rest[1:], 1, f"{what} bond/type")[0], f"{what} bond/type")
            rest = rest[2:]
        return cls(group, bond_type)

    def to_lammps(self) -> list[str]:
        return [] if self.bond_type is None else ["bond/type", str(self.bond_type)]

    def per_atom(self, state) -> np.ndarray:
        """(n,); zero outside the group."""
        topology = state.system.topology
        chosen = topology.bond_types > 0
        if self.bond_type is not None:
            chosen &= topology.bond_types == self.bond_type
        count = np.bincount(topology.bonds[chosen].ravel(), minlength=state.system.n)
        return np.where(state.mask(self.group), count, 0).astype(float)
