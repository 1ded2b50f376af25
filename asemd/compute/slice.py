r"""Some elements of global vectors: from Nstart on each Nskip-th, (Nstop - Nstart) / Nskip of them, that is without Nstop itself.

One input gives a vector, several an array with a column for each.

Source: LAMMPS manual, compute slice. Units: those of the input.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._inputs import Input, expand
from asemd.errors import InputError
from asemd.words import take, whole


class Slice(Compute):
    """Elements of vectors.

    Parameters
    ----------
    group : str
        Not used.
    first, last, every : int
        Elements, counted from 1; `last` is not included.
    inputs : sequence of asemd.compute._inputs.Input

    Raises
    ------
    InputError
        An impossible range, an input that is no global vector.
    """

    style = "slice"

    def __init__(self, group: str = "all", first: int = 1, last: int = 1, every: int = 1, inputs=()):
        super().__init__(group)
        if first < 1 or last < first or every < 1:
            raise InputError(f"compute slice: needs 1 <= Nstart <= Nstop and Nskip >= 1, got {first} {last} {every}")
        self.first, self.last, self.every, self.inputs = first, last, every, list(inputs)
        if not self.inputs:
            raise InputError("compute slice needs at least one value, for example: c_ID")
        for i in self.inputs:
            i.must_give("vector" if i.column is None else "array")

    @property
    def needs(self) -> frozenset[str]:
        return frozenset().union(*(i.needs for i in self.inputs))

    @property
    def extensive(self) -> bool:
        return any(getattr(i.source, "extensive", False) for i in self.inputs if i.kind != "v")

    @classmethod
    def from_lammps(cls, group, words, session):
        first, last, every = (whole(w, "compute slice") for w in take(words, 3, "compute slice (Nstart Nstop Nskip)"))
        inputs = expand(words[3:], session, "array")
        return cls(group, first, last, every, [Input(w, "compute slice", session) for w in inputs])

    @property
    def columns(self) -> int:
        """Of the array."""
        return len(self.inputs)

    @property
    def size(self) -> int:
        """Elements of the vector."""
        return (self.last - self.first) // self.every

    def to_lammps(self) -> list[str]:
        return [str(self.first), str(self.last), str(self.every), *map(str, self.inputs)]

    def _column(self, i: Input, state) -> np.ndarray:
        values = i.vector(state)
        if len(values) < self.last:
            raise InputError(f"compute {self.id} (slice): {i} has {len(values)} elements, not {self.last}")
        count = (self.last - self.first) // self.every
        return np.asarray(values, float)[self.first - 1:self.last - 1:self.every][:count]

    def vector(self, state) -> np.ndarray:
        """The elements of the only input."""
        if len(self.inputs) > 1:
            raise InputError(f"compute {self.id} (slice) has an array: write c_{self.id}[1][1]")
        return self._column(self.inputs[0], state)

    def array_columns(self) -> int | None:
        return len(self.inputs) if len(self.inputs) > 1 else None

    def array(self, state) -> np.ndarray:
        """(elements, inputs)."""
        if len(self.inputs) == 1:
            raise InputError(f"compute {self.id} (slice) has a vector: write c_{self.id}[1]")
        return np.column_stack([self._column(i, state) for i in self.inputs])
