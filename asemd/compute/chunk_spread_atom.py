r"""Values of chunks, given to each atom of the chunk; atoms of no chunk and outside the group have 0.

Source: LAMMPS manual, compute chunk/spread/atom. Units: those of the input.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked, read_chunks
from asemd.compute._inputs import Input, expand
from asemd.errors import InputError


class ChunkSpreadAtom(Chunked):
    """Values of chunks by atom.

    Parameters
    ----------
    group : str
        The atoms it reports.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    inputs : sequence of asemd.compute._inputs.Input
        Global vectors, or columns of arrays, with an element for each chunk.

    Raises
    ------
    InputError
        No input, an input of another kind.
    """

    style = "chunk/spread/atom"

    def __init__(self, group: str = "all", chunks=None, inputs=()):
        super().__init__(group, chunks)
        self.inputs = list(inputs)
        if not self.inputs:
            raise InputError("compute chunk/spread/atom needs at least one value, for example: c_ID[1]")
        for i in self.inputs:
            if i.kind not in "cf":
                raise InputError(f"compute chunk/spread/atom: {i} is neither a compute nor a fix")
            i.must_give("vector" if i.column is None else "array")

    @property
    def needs(self) -> frozenset[str]:
        return frozenset().union(self.chunks.needs, *(i.needs for i in self.inputs))

    @classmethod
    def from_lammps(cls, group, words, session):
        chunks = read_chunks(words, cls.style, session)
        inputs = expand(words[1:], session, "array")
        return cls(group, chunks, [Input(w, "compute chunk/spread/atom", session) for w in inputs])

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), *map(str, self.inputs)]

    def per_atom_columns(self) -> int:
        return len(self.inputs)

    def per_atom(self, state) -> np.ndarray:
        """(n,) for one input, (n, inputs) for several."""
        at, columns = self.index(state)[0], []
        for i in self.inputs:
            values = np.asarray(i.vector(state), float)
            known = (at > 0) & (at <= len(values))
            columns.append(np.where(known, np.append(values, 0.0)[np.where(known, at - 1, -1)], 0.0))
        return columns[0] if len(columns) == 1 else np.column_stack(columns)
