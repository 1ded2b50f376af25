r"""A global vector spread over atoms: each atom has the element whose number is its own value of the index.

Atoms whose index is below 1 or beyond the vector, and those outside the group, have 0.

Source: LAMMPS manual, compute global/atom. Units: those of the input.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._inputs import Input, expand
from asemd.errors import InputError
from asemd.words import take


class GlobalAtom(Compute):
    """Elements of vectors by atom.

    Parameters
    ----------
    group : str
        The atoms it reports.
    index : asemd.compute._inputs.Input
        Per-atom values, rounded down: elements, counted from 1.
    inputs : sequence of asemd.compute._inputs.Input
        Global vectors.

    Raises
    ------
    InputError
        An input of another kind.
    """

    style = "global/atom"

    def __init__(self, group: str = "all", index: Input | None = None, inputs=()):
        super().__init__(group)
        self.index, self.inputs = index, list(inputs)
        if index is None or not self.inputs:
            raise InputError("compute global/atom needs an index and at least one value")
        index.must_give("per_atom")
        for i in self.inputs:
            i.must_give("vector" if i.column is None else "array")

    @property
    def needs(self) -> frozenset[str]:
        return frozenset().union(self.index.needs, *(i.needs for i in self.inputs))

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute global/atom"
        index = Input(take(words, 1, f"{what} (index value ...)")[0], what, session)
        return cls(group, index, [Input(w, what, session) for w in expand(words[1:], session, "array")])

    def to_lammps(self) -> list[str]:
        return [str(self.index), *map(str, self.inputs)]

    def per_atom_columns(self) -> int:
        return len(self.inputs)

    def per_atom(self, state) -> np.ndarray:
        """(n,) for one input, (n, inputs) for several."""
        at, columns = self.index.per_atom(state).astype(int) - 1, []
        for i in self.inputs:
            values = np.asarray(i.vector(state), float)
            known = state.mask(self.group) & (at >= 0) & (at < len(values))
            columns.append(np.where(known, values[np.where(known, at, 0)], 0.0) if len(values) else np.zeros(len(at)))
        return columns[0] if len(columns) == 1 else np.column_stack(columns)
