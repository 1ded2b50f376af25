r"""Remove the linear and the angular momentum of each chunk of atoms every N steps.

What compute chunk/atom has put together loses the velocity of its centre of mass (``linear xflag yflag zflag``) and its rotation
(``angular``), as with fix momentum; with ``rescale`` the velocities of a chunk are then scaled so that its kinetic energy is what it was,
up to the first chunk that has none.

Source: LAMMPS manual, fix momentum/chunk.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import find_chunks
from asemd.compute._pieces import Pieces
from asemd.errors import InputError
from asemd.fix.momentum import Momentum
from asemd.words import take


class MomentumChunk(Momentum):
    """Stop drift and rotation of chunks.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two corrections.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    linear : sequence of 3 bool, optional
        Directions whose momentum goes; None: none.
    angular : bool
        Remove the rotation.
    rescale : bool
        Keep the kinetic energy of each chunk.

    Raises
    ------
    InputError
        No chunks, `every` below 1, or neither linear nor angular is asked for.
    """

    style = "momentum/chunk"

    def __init__(self, group: str = "all", every: int = 1, chunks=None, linear=None, angular: bool = False, rescale: bool = False):
        super().__init__(group, every, linear, angular, rescale)
        if chunks is None:
            raise InputError("fix momentum/chunk needs the ID of a compute chunk/atom")
        self.chunks = chunks

    @classmethod
    def from_lammps(cls, group, words, session):
        take(words, 2, "fix momentum/chunk (N chunkID)")
        chunks = find_chunks(words[1], "fix momentum/chunk", session)
        plain = Momentum.from_lammps(group, [words[0], *words[2:]], session)
        return cls(group, plain.every, chunks, plain.linear, plain.angular, plain.rescale)

    def to_lammps(self) -> list[str]:
        every, *words = super().to_lammps()
        return [every, self.chunks.id, *words]

    def end_of_step(self, loop) -> None:
        """Correct the velocities."""
        loop.sync_out()
        state, system = loop.snapshot(), loop.system
        at, count = self.chunks.assign(state)
        pieces = Pieces(system, np.where(loop.groups[self.group], at, 0), count)
        v, m = pieces.v, pieces.m
        before = pieces.sum(m * (v * v).sum(axis=1))
        if self.linear is not None:
            v = v - np.where(self.linear, pieces.vcm, 0.0)[pieces.at]
        if self.angular:
            v = v - np.cross(pieces.omega()[pieces.at], pieces.d)
        if self.rescale:
            after = pieces.sum(m * (v * v).sum(axis=1))
            scaled = np.logical_and.accumulate(after > 0.0)      # as LAMMPS: chunks after the first one at rest stay as they are
            v = v * np.sqrt(np.divide(before, after, out=np.ones(count), where=scaled))[pieces.at, None]
        system.v[pieces.rows] = v
        loop.sync_in()
