"""What compute pe and compute pe/atom share: keywords that pick terms of the energy."""
from __future__ import annotations

from asemd.compute import Compute
from asemd.errors import InputError, nearest

TERMS = {"pair": ("evdwl", "ecoul", "etail"), "bond": ("ebond",), "angle": ("eangle",), "dihedral": ("edihed",), "improper": ("eimp",),
         "kspace": ("elong",), "fix": ()}


class EnergyTerms(Compute):
    """Base class: the chosen `terms`, none for all."""

    def __init__(self, group: str = "all", terms=None):
        super().__init__(group)
        for term in terms or ():
            if term not in TERMS:
                raise InputError(f"compute {self.style}: unknown keyword {term!r}{nearest(term, TERMS)}")
        self.terms = tuple(terms or ())

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, words)

    def to_lammps(self) -> list[str]:
        return list(self.terms)
