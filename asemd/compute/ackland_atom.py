"""Crystal structure around each atom by the angles between its bonds: 0 unknown, 1 bcc, 2 fcc, 3 hcp, 4 icosahedral.

An atom needs at least 11 near neighbours, no two of them closer together in angle than 37 degrees. Seven straight angles
between bonds make it bcc, six fcc, three hcp; other numbers are judged by how far the histogram of angles is from those of the structures.

Source: LAMMPS manual, compute ackland/atom; Ackland and Jones, Phys. Rev. B 73, 054104 (2006). No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half
from asemd.errors import InputError
from asemd.kernels import order
from asemd.words import take, yes_no


class AcklandAtom(Compute):
    """Bond-angle analysis.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    legacy : bool
        The first form of the rules: the deviations from the structures decide throughout.
    """

    style = "ackland/atom"

    def __init__(self, group: str = "all", legacy: bool = False):
        super().__init__(group)
        self.legacy = legacy

    @classmethod
    def from_lammps(cls, group, words, session):
        rest, legacy = list(words), False
        while rest:
            if rest[0] != "legacy":
                raise InputError(f"compute ackland/atom: unknown keyword {rest[0]!r} (did you mean legacy?)")
            legacy, rest = yes_no(take(rest[1:], 1, "compute ackland/atom legacy")[0], "compute ackland/atom legacy"), rest[2:]
        return cls(group, legacy)

    def to_lammps(self) -> list[str]:
        return ["legacy", "yes"] * self.legacy

    def per_atom(self, state) -> np.ndarray:
        """(n,) 0 to 4; 0 outside the group."""
        n, out = state.system.n, np.zeros(state.system.n)
        start, _, vector, square = half(state, force_cutoff(state, "compute ackland/atom")).around(n)
        order.bond_angles(np.flatnonzero(state.mask(self.group)), start, vector, square, self.legacy, out)
        return out
