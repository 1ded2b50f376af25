r"""Temperature of chunks, and of all atoms in chunks.

.. math:: T = \frac{\sum_i m_i v_i^2}{f k_B}, \qquad f = \text{adof}\, N + \text{cdof}\, C

for N atoms in C chunks; ``adof`` is the dimension and ``cdof`` 0 by default. Values for each chunk: ``temp`` (with C = 1), ``kecom``
(kinetic energy of the centre of mass), ``internal`` (of the motion relative to it). With ``com yes`` the velocity of the centre of mass of
its chunk is a bias of each atom; ``bias ID`` names a compute that takes another one off first.

Source: LAMMPS manual, compute temp/chunk. Units: temperature; energies; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import find_chunks
from asemd.compute._pieces import Pieces
from asemd.compute.pressure import find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest
from asemd.words import number, take, yes_no

VALUES = ("temp", "kecom", "internal")
KEYWORDS = ("com", "bias", "adof", "cdof")


class TempChunk(Temp):
    """Temperature of chunks.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    values : sequence of str
        Columns of the array, of `VALUES`.
    com : bool
        Take the motion of chunks off.
    flow : asemd.compute.temp.Temp, optional
        A temperature with a bias, which is taken off first.
    adof, cdof : float, optional
        Degrees of freedom of each atom and of each chunk.

    Raises
    ------
    InputError
        No chunks, unknown values, `flow` without a bias or together with `com`.
    """

    style = "temp/chunk"

    def __init__(self, group: str = "all", chunks=None, values=(), com: bool = False, flow=None, adof: float | None = None,
                 cdof: float = 0.0):
        super().__init__(group)
        if chunks is None:
            raise InputError("compute temp/chunk needs the ID of a compute chunk/atom")
        if flow is not None and not flow.bias:
            raise InputError(f"compute temp/chunk bias: compute {flow.id} (style {flow.style}) takes no bias off the velocities")
        if flow is not None and com:
            raise InputError("compute temp/chunk: com yes and bias cannot go together")
        self.chunks, self.values, self.com, self.flow, self.adof, self.cdof = chunks, list(values), com, flow, adof, cdof
        self.bias = com

    @property
    def needs(self) -> frozenset[str]:
        return self.chunks.needs

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "compute temp/chunk"
        chunks = find_chunks(take(words, 1, f"{what} (chunkID)")[0], what, session)
        values, words, given = [], words[1:], {}
        while words and words[0] in VALUES:
            values, words = [*values, words[0]], words[1:]
        while words:
            key, what_ = words[0], f"{what} {words[0]}"
            if key not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, (*VALUES, *KEYWORDS))}")
            value = take(words[1:], 1, what_)[0]
            if key == "com":
                given["com"] = yes_no(value, what_)
            elif key == "bias":
                given["flow"] = find_temperature(value, session, what_)
            else:
                given[key] = number(value, what_)
            words = words[2:]
        return cls(group, chunks, values, **given)

    @property
    def columns(self) -> int:
        """Of the array."""
        return len(self.values)

    def to_lammps(self) -> list[str]:
        out = [self.chunks.id, *self.values] + ["com", "yes"] * self.com + (["bias", self.flow.id] if self.flow else [])
        return out + (["adof", repr(self.adof)] if self.adof is not None else []) + (["cdof", repr(self.cdof)] if self.cdof else [])

    def _pieces(self, state) -> tuple[np.ndarray, Pieces]:
        at, count = self.chunks.assign(state)
        return at, Pieces(state.system, np.where(state.mask(self.group), at, 0), count)

    def _dof_of_atom(self, state) -> float:
        return float(state.system.dimension) if self.adof is None else self.adof

    def dof(self, state) -> float:
        _, pieces = self._pieces(state.snapshot() if hasattr(state, "snapshot") else state)
        return max(self._dof_of_atom(state) * len(pieces.rows) + self.cdof * pieces.count, 0.0)

    def _weights(self, state) -> np.ndarray:
        at, _ = self.chunks.assign(state)
        return np.where(at > 0, super()._weights(state), 0.0)

    def _velocities(self, state) -> np.ndarray:
        v = state.system.v
        return v if self.flow is None else np.where(state.mask(self.flow.group)[:, None], self.flow.remove_bias(state), v)

    def _motion(self, pieces: Pieces, v: np.ndarray) -> np.ndarray:
        return pieces.mean(v[pieces.rows])

    def remove_bias(self, state) -> np.ndarray:
        v = self._velocities(state)
        if not self.com:
            return v
        at, pieces = self._pieces(state)
        return v - np.where(at[:, None] > 0, np.append(self._motion(pieces, v), np.zeros((1, 3)), axis=0)[at - 1], 0.0)

    def array_columns(self) -> int | None:
        return len(self.values) or None

    def array(self, state) -> np.ndarray:
        """(chunks, values)."""
        if not self.values:
            raise InputError(f"compute {self.id} (temp/chunk) has no array: name temp, kecom or internal after the ID of the chunks")
        _, pieces = self._pieces(state)
        v, unit = self._velocities(state), state.units.mvv2e
        motion, columns = self._motion(pieces, v), []
        for name in self.values:
            if name == "kecom":
                columns.append(0.5 * unit * pieces.mass * (motion * motion).sum(axis=1))
                continue
            w = v[pieces.rows] - (motion[pieces.at] if self.com or name == "internal" else 0.0)
            twice = unit * pieces.sum(pieces.m * (w * w).sum(axis=1))
            if name == "internal":
                columns.append(0.5 * twice)
            else:
                dof = self.cdof + self._dof_of_atom(state) * pieces.atoms
                columns.append(np.divide(twice, dof * state.units.boltz, out=np.zeros(pieces.count), where=dof > 0.0))
        return np.column_stack(columns)
