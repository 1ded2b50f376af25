r"""How many atoms, bonds, angles, dihedrals or impropers of each type there are.

Atoms count that are in the group, bonds ... all of whose atoms are. For bonds the scalar is the number of broken ones (type 0).

Source: LAMMPS manual, compute count/type. Units: none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError
from asemd.topology import ATOMS
from asemd.words import choice, exactly

MODES = ("atom", *ATOMS)


class CountType(Compute):
    """Counts by type.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    mode : str
        One of `MODES`.
    """

    style = "count/type"

    def __init__(self, group: str = "all", mode: str = "atom"):
        super().__init__(group)
        self.mode = choice(mode, MODES, "compute count/type")
        self.size: int | None = None        # of the vector, in a script

    @classmethod
    def from_lammps(cls, group, words, session):
        new = cls(group, exactly(words, 1, "compute count/type (atom, bond, angle, dihedral or improper)")[0])
        new.size = new._count(session.scene.need_system("compute count/type"))
        return new

    def to_lammps(self) -> list[str]:
        return [self.mode]

    def _count(self, system) -> int:
        return system.counts["ntypes" if self.mode == "atom" else f"n{self.mode}types"]

    def _types(self, state) -> np.ndarray:
        mask, system = state.mask(self.group), state.system
        if self.mode == "atom":
            return system.type[mask]
        items, types = getattr(system.topology, f"{self.mode}s"), getattr(system.topology, f"{self.mode}_types")
        return types[mask[items].all(axis=1)] if len(items) else types

    def scalar(self, state) -> float:
        """Broken bonds."""
        if self.mode != "bond":
            raise InputError(f"compute {self.id} (count/type {self.mode}) has no scalar, only mode bond has: write c_{self.id}[1]")
        return float(np.count_nonzero(self._types(state) == 0))

    def vector(self, state) -> np.ndarray:
        """A count for each type from 1 on."""
        return np.bincount(np.maximum(self._types(state), 0), minlength=self._count(state.system) + 1)[1:].astype(float)
