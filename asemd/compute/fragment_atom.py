"""Fragments of molecules: each atom gets the smallest ID of the atoms it is connected with by bonds.

Source: LAMMPS manual, compute fragment/atom. No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._clusters import bonded, smallest_ids
from asemd.errors import InputError
from asemd.words import take, yes_no


class FragmentAtom(Compute):
    """Clusters by bonds.

    Parameters
    ----------
    group : str
        Only its atoms and bonds between them form fragments.
    single : bool
        Atoms without bonds are fragments of their own, not 0.

    Raises
    ------
    InputError
        (From a script) an atom style without bonds.
    """

    style = "fragment/atom"

    def __init__(self, group: str = "all", single: bool = False):
        super().__init__(group)
        self.single = single

    @classmethod
    def from_lammps(cls, group, words, session):
        if not session.scene.need_system("compute fragment/atom").molecular:
            raise InputError(f"compute fragment/atom needs an atom style with bonds, not {session.scene.atom_style}")
        single, rest = False, list(words)
        while rest:
            if rest[0] != "single":
                raise InputError(f"compute fragment/atom: unknown keyword {rest[0]!r} (did you mean single?)")
            single, rest = yes_no(take(rest[1:], 1, "compute fragment/atom single")[0], "compute fragment/atom single"), rest[2:]
        return cls(group, single)

    def to_lammps(self) -> list[str]:
        return ["single", "yes"] * self.single

    def per_atom(self, state) -> np.ndarray:
        """(n,) IDs; 0 outside the group."""
        a, b = bonded(state)
        out = smallest_ids(state, state.mask(self.group), a, b)
        if not self.single:
            has = np.zeros(state.system.n, bool)
            has[a] = has[b] = True
            out[~has] = 0.0
        return out
