"""What computes bond, angle, dihedral and improper share: the energy of each sub-style of a hybrid."""
from __future__ import annotations

from typing import ClassVar

import numpy as np

from asemd.compute import Compute
from asemd.compute._items import evaluate
from asemd.errors import InputError


class SubStyles(Compute):
    """Base class: energies by sub-style of `category`.

    Parameters
    ----------
    group : str
        Has no effect: all items count.
    interactions : asemd.forcefield.Interactions
    """

    category: ClassVar[str] = ""

    def __init__(self, group: str = "all", interactions=None):
        super().__init__(group)
        if interactions is None or not interactions.hybrid[self.category]:
            raise InputError(f"compute {self.style}: the {self.category} style must be a hybrid; without one thermo keyword "
                             f"{ {'bond': 'ebond', 'angle': 'eangle', 'dihedral': 'edihed', 'improper': 'eimp'}[self.category] } "
                             "is the energy")
        self.interactions = interactions

    @property
    def size(self) -> int:
        """How many sub-styles there are."""
        return len(self.interactions.uses[self.category])

    @classmethod
    def from_lammps(cls, group, words, session):
        if words:
            raise InputError(f"compute {cls.style} takes no arguments, got {' '.join(words)}")
        return cls(group, session.scene.interactions)

    def vector(self, state) -> np.ndarray:
        """Energies of the sub-styles, in the order of the ``*_style hybrid`` command."""
        atoms, types = state.system.topology.items(self.category)
        out = []
        for use in self.interactions.uses[self.category]:
            mine = np.isin(types, list(use.coeff))
            energies, _ = evaluate(state.system, use, self.category, atoms[mine], types[mine], state.units, self.interactions.compat)
            out.append(float(energies.sum()))
        return np.array(out)
