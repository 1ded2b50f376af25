r"""Squared displacement of the centre of mass of each molecule from where it was when the compute was made.

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute msd/chunk.

Source: LAMMPS manual of 2013, compute msd/molecule. Units: distance squared. Columns: x, y, z, total.
"""
from __future__ import annotations

from asemd.compute._molecules import Molecules, start
from asemd.compute.msd_chunk import MSDChunk
from asemd.words import exactly


class MSDMolecule(MSDChunk):
    """Squared displacements of molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    """

    style = "msd/molecule"

    def __init__(self, group: str = "all"):
        super().__init__(group, Molecules(group))

    @classmethod
    def from_lammps(cls, group, words, session):
        exactly(words, 0, "compute msd/molecule")
        new = cls(group)
        new.setup(start(new, session))
        return new

    def to_lammps(self) -> list[str]:
        return []
