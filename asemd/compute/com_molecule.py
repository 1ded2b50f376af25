r"""Centre of mass of each molecule, of unwrapped positions.

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute com/chunk.

Source: LAMMPS manual of 2013, compute com/molecule. Units: distance. Columns: x, y, z.
"""
from __future__ import annotations

from asemd.compute._molecules import Molecules, start
from asemd.compute.com_chunk import COMChunk
from asemd.words import exactly


class COMMolecule(COMChunk):
    """Centres of mass of molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    """

    style = "com/molecule"

    def __init__(self, group: str = "all"):
        super().__init__(group, Molecules(group))

    @classmethod
    def from_lammps(cls, group, words, session):
        exactly(words, 0, "compute com/molecule")
        new = cls(group)
        start(new, session)
        return new

    def to_lammps(self) -> list[str]:
        return []
