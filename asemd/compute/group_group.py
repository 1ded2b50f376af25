"""Energy between two groups of atoms, and the force of the second on the first.

Source: LAMMPS manual, compute group/group. Units: energy; the vector is a force.
"""
from __future__ import annotations

import math

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
    kspace, boundary : bool
        Whether what the long-range solver adds counts; and with it the energy of the uniform charge that neutralises the groups.
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

    def __init__(self, group: str = "all", other: str = "all", pair: bool = True, kspace: bool = False,
                 boundary: bool = True, molecule: str = "off"):
        super().__init__(group)
        self.other, self.pair, self.kspace, self.boundary = other, pair, kspace, boundary
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
            else:
                given[word] = yes_no(value, f"compute group/group {word}")
        if given.get("molecule", "off") != "off" and not scene.need_system("compute group/group").molecular:
            raise InputError("compute group/group molecule needs an atom style with molecule numbers")
        return cls(group, other, **given)

    def to_lammps(self) -> list[str]:
        return [self.other, *(w for k in KEYWORDS[:3] for w in (k, "yes" if getattr(self, k) else "no")), "molecule", self.molecule]

    def setup(self, state) -> None:
        if self.kspace:
            _solver_terms(state)

    def _evaluate(self, state) -> tuple[float, np.ndarray]:
        energy, force = self._of_pairs(state) if self.pair else (0.0, np.zeros(3))
        if self.kspace:
            more, push = self._of_solver(state)
            energy, force = energy + more, force + push
        return energy, force

    def _of_solver(self, state) -> tuple[float, np.ndarray]:
        """A charge's energy of its own counts once for atoms of both groups, the energy between the groups twice less that within both."""
        q, x, both = state.system.q, state.system.x, state.mask(self.group) & state.mask(self.other)
        first, second, common = (np.where(mask, q, 0.0) for mask in (state.mask(self.group), state.mask(self.other), both))
        mine, theirs = state.mask(self.group) & ~both, state.mask(self.other) & ~both
        energy, force = 0.0, np.zeros(3)
        for term in _solver_terms(state):
            def of(charges, term=term):
                return term.of_charges(state.engine, charges, x)
            energy += of(first + second)[0] - of(first)[0] - of(second)[0] - of(common)[0]
            # solvers keep momentum: groups exert no force on themselves
            whole = of(first + second - common)[1]
            apart = of(first + second - 2.0 * common)[1][mine].sum(axis=0)
            force += whole[mine].sum(axis=0) - whole[theirs].sum(axis=0) - apart
            if not self.boundary:
                g, scale, volume = term.constants[0], term.constants[1], state.system.box.volume * term.solver.stretch.prod()
                energy += math.pi * scale * (first.sum() * second.sum() - 0.5 * common.sum() ** 2) / (g * g * volume)
        return energy, force

    def _of_pairs(self, state) -> tuple[float, np.ndarray]:
        p = half(state, force_cutoff(state, "compute group/group"))
        first, second = state.mask(self.group), state.mask(self.other)
        ahead, back = first[p.i] & second[p.j], first[p.j] & second[p.i]
        keep = (ahead | back) & (p.r2 < type_cutoffs(state)[state.system.type[p.i], state.system.type[p.j]] ** 2)
        if self.molecule != "off":
            same = state.system.molecule[p.i] == state.system.molecule[p.j]
            keep &= same == (self.molecule == "intra")
        energy, force = interactions(state, p.take(keep), single=True)
        sign = ahead[keep].astype(float) - back[keep]
        return float(energy.sum()), (sign[:, None] * force).sum(axis=0)

    def scalar(self, state) -> float:
        """The energy."""
        return self._evaluate(state)[0]

    def vector(self, state) -> np.ndarray:
        """(3,) the force on the first group."""
        return self._evaluate(state)[1]


def _solver_terms(state) -> list:
    """The terms of the long-range solver.

    Raises
    ------
    InputError
        There is none, or it has no interaction of groups, as in LAMMPS.
    """
    solver = state.engine.solver if state.engine is not None else None
    if solver is None:
        raise InputError("compute group/group kspace yes needs a kspace_style")
    if not solver.groups:
        raise InputError(f"compute group/group kspace yes does not work with kspace_style {solver.style}: use ewald or pppm")
    if solver.wire:
        raise InputError("compute group/group kspace yes does not work with kspace_modify wire, whose correction is for neutral groups")
    if solver.modify["diff"] == "ad" and solver.style != "ewald":
        raise InputError("compute group/group kspace yes does not work with kspace_modify diff ad: use diff ik")
    return [term for term in state.engine.terms if term.category == "kspace"]
