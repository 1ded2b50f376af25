r"""Tensor of inertia of each molecule about its centre of mass.

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute inertia/chunk.

Source: LAMMPS manual of 2013, compute inertia/molecule. Units: mass times distance squared. Columns: xx yy zz xy yz xz.
"""
from __future__ import annotations

from asemd.compute._molecules import Molecules, start
from asemd.compute.inertia_chunk import InertiaChunk
from asemd.words import exactly


class InertiaMolecule(InertiaChunk):
    """Tensors of inertia of molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    """

    style = "inertia/molecule"

    def __init__(self, group: str = "all"):
        super().__init__(group, Molecules(group))

    @classmethod
    def from_lammps(cls, group, words, session):
        exactly(words, 0, "compute inertia/molecule")
        new = cls(group)
        start(new, session)
        return new

    def to_lammps(self) -> list[str]:
        return []
