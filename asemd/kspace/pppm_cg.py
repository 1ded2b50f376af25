"""Particle-particle particle-mesh where most atoms have no charge: pppm that passes over charges of at most a smallest one.

Error estimates and the energy that charges have by themselves count every charge, as in LAMMPS.
"""
from __future__ import annotations

from asemd import words as read
from asemd.errors import InputError
from asemd.kspace.pppm import PPPM


class FewCharges:
    """What solvers with a smallest charge have in common; before the class of the solver that they are otherwise."""

    style = ""
    least = 1e-5

    @classmethod
    def from_words(cls, words, modify=None):
        if len(words) not in (1, 2):
            raise InputError(f"kspace_style {cls.style} needs the accuracy and, optionally, the smallest charge, got {len(words)} words")
        solver = super().from_words(words[:1], modify)
        if len(words) == 2:
            solver.least = abs(read.number(words[1], f"kspace_style {cls.style}: smallest charge"))
        return solver


class PPPMCG(FewCharges, PPPM):
    """``kspace_style pppm/cg accuracy [smallest charge]``; the latter is 1e-5 without that word."""

    style = "pppm/cg"
