"""Pair styles of charges of which each stands in a medium of its own."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.pairstyle import PairStyle


class DielectricPair(PairStyle):
    """A pair style for atoms of style dielectric; its functions are those of a homogeneous medium."""

    listed = True
    dielectric = True

    def __init__(self, name, parts, **options):
        super().__init__(name, parts, **{**dict(see=f"LAMMPS manual, pair_style {name}"), **options})
        self.solvers = frozenset(f"{solver}/dielectric" for solver in self.solvers & {"pppm", "msm"})
        self.xfail["gradient"] = "forces on the two atoms of a pair are not opposite, and no gradient of an energy"

    def check_scene(self, interactions, system):
        if system.q is None or "epsilon" not in system.extra:
            raise InputError(f"pair style {self.name} needs atoms with charges and dielectric constants: use atom_style dielectric")
