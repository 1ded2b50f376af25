r"""Springs that hold the centre of mass of each chunk where it was at first.

.. math:: E = \sum_c \tfrac12 K (R_c - R_c^0)^2, \qquad F_i = -K (R_c - R_c^0) \frac{m_i}{M_c}

over the chunks of compute chunk/atom, with the centres of compute com/chunk, which are unwrapped. All atoms of a chunk feel its spring,
whatever the group of the fix. The number of chunks stays what it was at first. A chunk whose centre is that of no atoms has no spring.
LAMMPS pulls with the force K at any distance, as is seen with ``compat lammps``.

Source: LAMMPS manual, fix spring/chunk. Arguments: K (force/distance units), the ID of a compute chunk/atom and that of a compute com/chunk
of it. Output: a scalar, the energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import find_chunks
from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.words import exactly, number, yes_no


class SpringChunk(Fix):
    """A spring at the centre of mass of each chunk.

    Parameters
    ----------
    group : str
        Has no meaning here: the atoms are those of the chunks.
    k : float
        Spring constant, force/distance units of the scene.
    centres : asemd.compute.com_chunk.COMChunk
        The centres, of chunks that it knows.

    Raises
    ------
    InputError
        No centres; during a run: another number of chunks than before.
    """

    style = "spring/chunk"
    minimizes = True
    levels = "one"
    extensive = True

    def __init__(self, group: str = "all", k: float = 1.0, centres=None):
        super().__init__(group)
        if centres is None:
            raise InputError("fix spring/chunk needs the ID of a compute com/chunk")
        self.k, self.centres = k, centres
        self.places: np.ndarray | None = None       # (chunks, 3)
        self.energy, self._holds = 0.0, False

    @classmethod
    def from_lammps(cls, group, words, session):
        k, chunk_id, id = exactly(words, 3, "fix spring/chunk (K chunkID comID)")
        chunks, computes = find_chunks(chunk_id, "fix spring/chunk", session), session.scene.computes
        if id not in computes:
            raise InputError(f"fix spring/chunk: there is no compute {id}{nearest(id, computes)}")
        if computes[id].style != "com/chunk":
            raise InputError(f"fix spring/chunk: compute {id} has style {computes[id].style}, not com/chunk")
        if computes[id].chunks is not chunks:
            raise InputError(f"Fix spring/chunk chunkID {chunk_id} not same as comID chunkID {computes[id].chunks.id}")
        return cls(group, number(k, "fix spring/chunk K"), computes[id])

    def to_lammps(self) -> list[str]:
        return [repr(float(self.k)), self.centres.chunks.id, self.centres.id]

    def post_force(self, loop) -> None:
        """Add the forces of the springs."""
        loop.sync_out()
        snapshot, chunks = loop.snapshot(), self.centres.chunks
        if not self._holds:
            chunks.hold(snapshot)
            self._holds = True
        at, count = chunks.assign(snapshot)
        pieces = self.centres.pieces(snapshot)
        if self.places is None:
            self.places = pieces.com.copy()
        if len(self.places) != count:
            raise InputError(f"fix spring/chunk {self.id}: there are {count} chunks of compute {chunks.id}, {len(self.places)} at first")
        away = np.where(pieces.mass[:, None] > 0.0, pieces.com - self.places, 0.0)
        self.energy = 0.5 * self.k * float((away * away).sum())
        if loop.interactions.compat == "lammps":      # whose force does not grow with the distance
            r = np.sqrt((away * away).sum(axis=1))[:, None]
            away = away / np.maximum(r, 1e-10)
        pull = np.divide(-self.k * away, pieces.mass[:, None], out=np.zeros_like(away), where=pieces.mass[:, None] > 0.0)
        rows = np.flatnonzero(at)
        force = pull[at[rows] - 1] * loop.system.atom_masses()[rows, None]
        loop.state.f[:, loop.engine.slot_of[rows]] += force.T

    def detach(self, system) -> None:
        if self._holds:
            self.centres.chunks.release()
            self._holds = False

    def scalar(self) -> float:
        """Energy of the springs, energy units."""
        return self.energy

    def modify_option(self, keyword, value, session):
        if keyword == "energy":
            self.thermo_energy = yes_no(value, "fix_modify energy")
            return True
        return super().modify_option(keyword, value, session)

    def state(self) -> dict:
        """Where the centres were at first."""
        return {} if self.places is None else {"places": self.places}

    def restore(self, state: dict) -> None:
        self.places = np.array(state["places"]) if "places" in state else None
