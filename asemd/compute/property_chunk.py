r"""What chunks are: ``count`` (atoms of the group), ``id`` (number before compression), ``coord1 coord2 coord3`` (middles of bins).

Source: LAMMPS manual, compute property/chunk. Units: distance for coordinates, or none with ``units reduced``.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._chunked import Chunked, read_chunks
from asemd.errors import InputError, nearest

NAMES = ("count", "id", "coord1", "coord2", "coord3")


class PropertyChunk(Chunked):
    """Attributes of chunks.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    names : sequence of str
        Of `NAMES`.

    Raises
    ------
    InputError
        Unknown names, ids of chunks that are not compressed, coordinates of chunks that have none.
    """

    style = "property/chunk"

    def __init__(self, group: str = "all", chunks=None, names=()):
        super().__init__(group, chunks)
        self.names, bins = list(names), chunks.settings.bins
        if not self.names:
            raise InputError("compute property/chunk needs at least one attribute, for example: count")
        for name in self.names:
            if name not in NAMES:
                raise InputError(f"compute property/chunk: unknown attribute {name!r}{nearest(name, NAMES)}")
            if name == "id" and not chunks.settings.compress:
                raise InputError(f"compute property/chunk: id needs compress yes in compute {chunks.id}")
            if name.startswith("coord") and (not bins or int(name[5]) > bins.directions):
                raise InputError(f"compute property/chunk: chunks of compute {chunks.id} have no {name}")

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, read_chunks(words, cls.style, session), words[1:])

    @property
    def columns(self) -> int:
        """Of the array."""
        return len(self.names)

    def to_lammps(self) -> list[str]:
        return [*super().to_lammps(), *self.names]

    def _column(self, name: str, state) -> np.ndarray:
        if name == "count":
            return self.pieces(state).atoms.astype(float)
        if name == "id":
            return self.chunks.numbers_of_chunks(state).astype(float)
        return self.chunks.coordinates(state)[:, int(name[5]) - 1]

    def vector(self, state) -> np.ndarray:
        """(chunks,) for one attribute."""
        if len(self.names) > 1:
            raise InputError(f"compute {self.id} (property/chunk) has an array: write c_{self.id}[1][1]")
        return self._column(self.names[0], state)

    def array_columns(self) -> int | None:
        return len(self.names) if len(self.names) > 1 else None

    def array(self, state) -> np.ndarray:
        """(chunks, k) for several."""
        if len(self.names) == 1:
            raise InputError(f"compute {self.id} (property/chunk) has a vector: write c_{self.id}[1]")
        return np.column_stack([self._column(name, state) for name in self.names])
