"""The term of pair styles that name their pairs of atoms one by one."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from asemd.errors import InputError
from asemd.term import BondedTerm


class ItemsTerm(BondedTerm):
    """Pairs of atoms that a pair style names one by one (``list``), computed as bonds are; their energy is that of the pair style.

    Raises
    ------
    InputError
        The pair style has a variable for a factor, or atoms do not exist.
    """

    def __init__(self, use, system, interactions, units):
        if isinstance(use.scale, str):
            raise InputError(f"pair style {use.style.name} cannot have a factor that changes during a run, v_{use.scale}")
        rows, coeff = use.style.items(use.settings, system, interactions.modified(use, "shift"), use.scale)
        kinds = np.arange(1, len(rows) + 1)
        bonds = SimpleNamespace(style=use.style.items_style, settings={}, coeff=dict(zip(kinds.tolist(), coeff)))
        super().__init__("pair", bonds, np.array(rows, np.int32).reshape(-1, 2), kinds, len(rows), units)
        self.owner, self.images = SimpleNamespace(use=use), interactions.compat != "lammps"

    def rebuild(self, engine):
        super().rebuild(engine)
        self.periodic &= self.images
