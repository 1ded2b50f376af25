"""How many spheres each atom touches: those closer than the sum of the two radii.

Source: LAMMPS manual, compute contact/atom. No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import half
from asemd.errors import InputError
from asemd.words import take


class ContactAtom(Compute):
    """Contacts.

    Parameters
    ----------
    group : str
        The atoms it reports.
    neighbors : str
        Only contacts with atoms of this group count.

    Raises
    ------
    InputError
        (When it is evaluated, or from a script) atoms without a radius.
    """

    style = "contact/atom"

    def __init__(self, group: str = "all", neighbors: str = "all"):
        super().__init__(group)
        self.neighbors = neighbors

    @classmethod
    def from_lammps(cls, group, words, session):
        scene = session.scene
        radius_of(scene.need_system("compute contact/atom"))
        if len(words) > 1:
            raise InputError(f"compute contact/atom takes one group at most, got {' '.join(words)}")
        if words:
            scene.groups.mask(words[0], "compute contact/atom")
        if not scene.interactions.uses["pair"]:
            raise InputError("compute contact/atom needs a pair style, whose neighbour list it uses")
        return cls(group, take(words, 1, "")[0] if words else "all")

    def to_lammps(self) -> list[str]:
        return [self.neighbors] if self.neighbors != "all" else []

    def per_atom(self, state) -> np.ndarray:
        """(n,) numbers of contacts; 0 outside the group."""
        n, radius, inside, other = state.system.n, radius_of(state.system), state.mask(self.group), state.mask(self.neighbors)
        pairs = half(state, 2.0 * float(radius.max(initial=0.0)) * (1.0 + 1e-12) + 1e-300)
        touch = pairs.r2 <= (radius[pairs.i] + radius[pairs.j]) ** 2
        i, j = pairs.i[touch], pairs.j[touch]
        out = np.bincount(i[other[j]], minlength=n) + np.bincount(j[other[i]], minlength=n)
        return np.where(inside, out, 0).astype(float)


def radius_of(system) -> np.ndarray:
    if "radius" not in system.extra:
        raise InputError(f"compute contact/atom needs atoms with a radius, such as atom_style sphere, not {system.atom_style}")
    return system.extra["radius"]
