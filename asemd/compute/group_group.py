"""Energy between two groups of atoms, and the force of the second on the first.

Source: LAMMPS manual, compute group/group. Units: energy; the vector is a force.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half, interactions, type_cutoffs
from asemd.errors import InputError, nearest
from asemd.words import choice, take, yes_no

KEYWORDS = ("pair", "kspace", "boundary", "molecule")


class GroupGroup(Compute):
    """Interaction of two groups.

    Parameters
    ----------
    group, other : str
        The groups, which may be the same or have atoms in common.
    pair : bool
        Whether pair interactions count.
    molecule : str
        ``off``: all pairs; ``inter``: of different molecules; ``intra``: of the same one.

    Raises
    ------
    InputError
        Molecules other than these.
    """

    style = "group/group"
    extensive = True
    size = 3

    def __init__(self, group: str = "all", other: str = "all", pair: bool = True, molecule: str = "off"):
        super().__init__(group)
        self.other, self.pair = other, pair
        self.molecule = choice(molecule, ("off", "inter", "intra"), "compute group/group molecule")

    @classmethod
    def from_lammps(cls, group, words, session):
        other, rest, given = take(words, 1, "compute group/group")[0], list(words[1:]), {}
        scene = session.scene
        scene.groups.mask(other, "compute group/group")
        while rest:
            word, value = rest[0], take(rest[1:], 1, f"compute group/group {rest[0]}")[0]
            rest = rest[2:]
            if word not in KEYWORDS:
                raise InputError(f"compute group/group: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
            if word == "molecule":
                given[word] = value
            elif word == "pair":
                given[word] = yes_no(value, "compute group/group pair")
            elif yes_no(value, f"compute group/group {word}") and word == "kspace":
                raise InputError("compute group/group kspace yes: there is no kspace style")
        if given.get("molecule", "off") != "off" and not scene.need_system("compute group/group").molecular:
            raise InputError("compute group/group molecule needs an atom style with molecule numbers")
        if not scene.interactions.uses["pair"]:
            raise InputError("compute group/group needs a pair style")
        return cls(group, other, **given)

    def to_lammps(self) -> list[str]:
        return [self.other, "pair", "yes" if self.pair else "no", "molecule", self.molecule]

    def _evaluate(self, state) -> tuple[float, np.ndarray]:
        if not self.pair:
            return 0.0, np.zeros(3)
        p = half(state, force_cutoff(state, "compute group/group"))
        first, second = state.mask(self.group), state.mask(self.other)
        ahead, back = first[p.i] & second[p.j], first[p.j] & second[p.i]
        keep = (ahead | back) & (p.r2 < type_cutoffs(state)[state.system.type[p.i], state.system.type[p.j]] ** 2)
        if self.molecule != "off":
            same = state.system.molecule[p.i] == state.system.molecule[p.j]
            keep &= same == (self.molecule == "intra")
        energy, force = interactions(state, p.take(keep))
        sign = ahead[keep].astype(float) - back[keep]
        return float(energy.sum()), (sign[:, None] * force).sum(axis=0)

    def scalar(self, state) -> float:
        """The energy."""
        return self._evaluate(state)[0]

    def vector(self, state) -> np.ndarray:
        """(3,) the force on the first group."""
        return self._evaluate(state)[1]
