r"""Radius of gyration of each molecule, or with ``tensor`` the tensor whose trace is its square.

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute gyration/chunk.

Source: LAMMPS manual of 2013, compute gyration/molecule. Units: distance, or distance squared (xx yy zz xy xz yz).
"""
from __future__ import annotations

from asemd.compute._molecules import Molecules, start
from asemd.compute.gyration_chunk import GyrationChunk
from asemd.errors import InputError


class GyrationMolecule(GyrationChunk):
    """Radii of gyration of molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    tensor : bool
        An array of tensors instead of a vector of radii.
    """

    style = "gyration/molecule"

    def __init__(self, group: str = "all", tensor: bool = False):
        super().__init__(group, Molecules(group), tensor)

    @classmethod
    def from_lammps(cls, group, words, session):
        if words not in ([], ["tensor"]):
            raise InputError(f"compute gyration/molecule takes one keyword, tensor, got {' '.join(words)}")
        new = cls(group, bool(words))
        start(new, session)
        return new

    def to_lammps(self) -> list[str]:
        return ["tensor"] if self.tensor else []
