r"""Sums of per-atom values over each molecule.

The molecules are those with atoms in the group, in ascending order of their ids; today's form is compute reduce/chunk.

Source: LAMMPS manual of 2013, compute atom/molecule. Units: those of the input.
"""
from __future__ import annotations

from asemd.compute._inputs import Input, expand
from asemd.compute._molecules import Molecules, start
from asemd.compute.reduce_chunk import ReduceChunk


class AtomMolecule(ReduceChunk):
    """Sums over molecules.

    Parameters
    ----------
    group : str
        The atoms that count.
    inputs : sequence of asemd.compute._inputs.Input
        Per-atom values.
    """

    style = "atom/molecule"
    extensive = True

    def __init__(self, group: str = "all", inputs=()):
        super().__init__(group, Molecules(group), "sum", inputs)

    @classmethod
    def from_lammps(cls, group, words, session):
        inputs = expand(words, session, "per_atom")
        new = cls(group, [Input(w, "compute atom/molecule", session) for w in inputs])
        start(new, session)
        return new

    def to_lammps(self) -> list[str]:
        return [str(i) for i in self.inputs]
