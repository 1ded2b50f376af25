r"""Displacement of each atom from where it was when the compute was made, of unwrapped positions.

With ``refresh name`` those atoms start anew for which the atom-style variable is not zero, whenever a dump with ``dump_modify refresh`` has
written them.

Source: LAMMPS manual, compute displace/atom. Units: distance. Columns: dx, dy, dz, their length.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._original import Original, unwrapped
from asemd.errors import InputError, nearest
from asemd.words import take


class DisplaceAtom(Compute):
    """Displacements.

    Parameters
    ----------
    group : str
        The atoms it reports.
    """

    style = "displace/atom"

    def __init__(self, group: str = "all"):
        super().__init__(group)
        self.original: Original | None = None
        self.variable, self.session = "", None

    @classmethod
    def from_lammps(cls, group, words, session):
        new, what = cls(group), "compute displace/atom"
        while words:
            if words[0] != "refresh":
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], ['refresh'])}")
            name = take(words[1:], 1, f"{what} refresh")[0]
            if session.variables.find(name).style != "atom":
                raise InputError(f"{what} refresh: variable {name} must have style atom")
            new.variable, new.session, words = name, session, words[2:]
        system = session.scene.need_system(what)
        new.original = Original(system, unwrapped(system))
        return new

    def to_lammps(self) -> list[str]:
        return ["refresh", self.variable] if self.variable else []

    def per_atom_columns(self) -> int:
        return 4

    def per_atom(self, state) -> np.ndarray:
        """(n, 4) displacement and its length; zero outside the group."""
        system, now = state.system, unwrapped(state.system)
        if self.original is None:
            self.original = Original(system, now)
        d = now - self.original.of(system, now)
        return np.where(state.mask(self.group)[:, None], np.column_stack([d, np.sqrt((d * d).sum(axis=1))]), 0.0)

    def refresh(self) -> None:
        """New original positions for atoms that the variable names.

        Raises
        ------
        InputError
            There is no variable.
        """
        if not self.variable:
            raise InputError(f"dump_modify refresh: compute {self.id} (style {self.style}) has no refresh variable")
        system = self.session.scene.system
        now, again = unwrapped(system), self.session.variables.per_atom(self.variable, system.n) != 0.0
        self.original.update(system, np.where(again[:, None], now, self.original.of(system, now)))
