r"""One number for each chunk: the sum, smallest or largest value of its atoms.

Source: LAMMPS manual, compute reduce/chunk. Units: those of the input.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked, read_chunks
from asemd.compute._inputs import Input, expand
from asemd.errors import InputError
from asemd.words import choice, take

MODES = ("sum", "min", "max")
EMPTY = 1.0e20      # the smallest of no values, minus the largest


class ReduceChunk(Chunked):
    """Reduction by chunk.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    mode : str
        One of `MODES`.
    inputs : sequence of asemd.compute._inputs.Input
        Per-atom values.

    Raises
    ------
    InputError
        Unknown mode, no input, an input of another kind.
    """

    style = "reduce/chunk"

    def __init__(self, group: str = "all", chunks=None, mode: str = "sum", inputs=()):
        super().__init__(group, chunks)
        self.mode, self.inputs = choice(mode, MODES, "compute reduce/chunk mode"), list(inputs)
        if not self.inputs:
            raise InputError(f"compute {self.style} needs at least one value, for example: c_ID")
        for i in self.inputs:
            i.must_give("per_atom")

    @property
    def needs(self) -> frozenset[str]:
        return frozenset().union(self.chunks.needs, *(i.needs for i in self.inputs))

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute reduce/chunk"
        chunks = read_chunks(words, cls.style, session)
        mode = take(words[1:], 1, f"{what} (chunkID mode value ...)")[0]
        return cls(group, chunks, mode, [Input(w, what, session) for w in expand(words[2:], session, "per_atom")])

    @property
    def columns(self) -> int:
        """Of the array."""
        return len(self.inputs)

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), self.mode, *map(str, self.inputs)]

    def _column(self, i: Input, state) -> np.ndarray:
        at, count = self.index(state)
        rows = np.flatnonzero(at)
        values, at = i.per_atom(state)[rows], at[rows] - 1
        if self.mode == "sum":
            return np.bincount(at, values, count)
        out = np.full(count, EMPTY if self.mode == "min" else -EMPTY)
        (np.minimum if self.mode == "min" else np.maximum).at(out, at, values)
        return out

    def vector(self, state) -> np.ndarray:
        """(chunks,) for one input."""
        if len(self.inputs) > 1:
            raise InputError(f"compute {self.id} ({self.style}) has an array: write c_{self.id}[1][1]")
        return self._column(self.inputs[0], state)

    def array_columns(self) -> int | None:
        return len(self.inputs) if len(self.inputs) > 1 else None

    def array(self, state) -> np.ndarray:
        """(chunks, inputs) for several."""
        if len(self.inputs) == 1:
            raise InputError(f"compute {self.id} ({self.style}) has a vector: write c_{self.id}[1]")
        return np.column_stack([self._column(i, state) for i in self.inputs])
