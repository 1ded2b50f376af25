r"""What molecules are: ``mol`` (their ids) and ``count`` (atoms of the group).

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute property/chunk.

Source: LAMMPS manual of 2013, compute property/molecule. Units: none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._molecules import Molecules, start
from asemd.errors import InputError, nearest

NAMES = ("mol", "count")


class PropertyMolecule(Compute):
    """Attributes of molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    names : sequence of str
        Of `NAMES`.

    Raises
    ------
    InputError
        No name, or an unknown one.
    """

    style = "property/molecule"

    def __init__(self, group: str = "all", names=()):
        super().__init__(group)
        self.molecules, self.names = Molecules(group), list(names)
        if not self.names:
            raise InputError("compute property/molecule needs at least one attribute: mol or count")
        for name in self.names:
            if name not in NAMES:
                raise InputError(f"compute property/molecule: unknown attribute {name!r}{nearest(name, NAMES)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        new = cls(group, words)
        start(new, session)
        return new

    def to_lammps(self) -> list[str]:
        return self.names

    @property
    def columns(self) -> int:
        """Of the array."""
        return len(self.names)

    def _column(self, name: str, state) -> np.ndarray:
        if name == "mol":
            return self.molecules.ids(state).astype(float)
        at, count = self.molecules.assign(state)
        return np.bincount(at[at > 0] - 1, minlength=count).astype(float)

    def vector(self, state) -> np.ndarray:
        """(molecules,) for one attribute."""
        if len(self.names) > 1:
            raise InputError(f"compute {self.id} (property/molecule) has an array: write c_{self.id}[1][1]")
        return self._column(self.names[0], state)

    def array_columns(self) -> int | None:
        return len(self.names) if len(self.names) > 1 else None

    def array(self, state) -> np.ndarray:
        """(molecules, k) for several."""
        if len(self.names) == 1:
            raise InputError(f"compute {self.id} (property/molecule) has a vector: write c_{self.id}[1]")
        return np.column_stack([self._column(name, state) for name in self.names])
