"""What computes of chunks share: the compute chunk/atom they sum over."""
from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from asemd.compute import Compute
from asemd.compute._pieces import Pieces
from asemd.errors import InputError, nearest
from asemd.words import take


def find_chunks(id: str, what: str, session) -> Compute:
    """The compute chunk/atom of that ID."""
    computes = session.scene.computes
    if id not in computes:
        raise InputError(f"{what}: there is no compute {id}{nearest(id, computes)}")
    if computes[id].style != "chunk/atom":
        raise InputError(f"{what}: compute {id} has style {computes[id].style}, not chunk/atom")
    return computes[id]


def read_chunks(words: list[str], style: str, session) -> Compute:
    """That of the first word after the style's name."""
    return find_chunks(take(words, 1, f"compute {style} (chunkID)")[0], f"compute {style}", session)


class Chunked(Compute):
    """Base class: ``compute ID group style chunkID``.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.chunk_atom.ChunkAtom
    """

    def __init__(self, group: str = "all", chunks=None):
        super().__init__(group)
        if chunks is None:
            raise InputError(f"compute {self.style} needs the ID of a compute chunk/atom")
        self.chunks = chunks

    def array_columns(self) -> int | None:
        return getattr(self, "columns", None)

    @property
    def needs(self) -> frozenset[str]:
        return self.chunks.needs

    @classmethod
    def from_lammps(cls, group, words, session):
        chunks = read_chunks(words, cls.style, session)
        if len(words) > 1:
            raise InputError(f"compute {cls.style} takes the ID of a compute chunk/atom only, got {' '.join(words[1:])} besides")
        return cls(group, chunks)

    def to_lammps(self) -> list[str]:
        return [self.chunks.id]

    def index(self, state) -> tuple[np.ndarray, int]:
        """(n,) the chunk of each atom of the group, 0 for none, and how many there are."""
        at, count = self.chunks.assign(state)
        mask = state.mask(self.group)
        return at if mask.all() else np.where(mask, at, 0), count

    def pieces(self, state) -> Pieces:
        return Pieces(state.system, *self.index(state))


class SinceStart(Chunked, ABC):
    """Base class: what a value of each chunk has become since the start of the first run after the compute was made."""

    columns = 4     # of the array

    def __init__(self, group: str = "all", chunks=None):
        super().__init__(group, chunks)
        self.original: np.ndarray | None = None

    @abstractmethod
    def value(self, state) -> np.ndarray:
        """(chunks, 3) that of now."""

    @abstractmethod
    def products(self, now: np.ndarray) -> np.ndarray:
        """(chunks, 3) of the present value and the original one."""

    def setup(self, state) -> None:
        """At the start of the first run: the values of now are the original ones."""
        if self.original is None:
            self.original = self.value(state)

    def array(self, state) -> np.ndarray:
        """(chunks, 4) x, y, z and their sum.

        Raises
        ------
        InputError
            The number of chunks is not that of the start.
        """
        self.setup(state)
        now = self.value(state)
        if len(now) != len(self.original):
            raise InputError(f"compute {self.id} ({self.style}): there were {len(self.original)} chunks, now {len(now)}; "
                             "let compute chunk/atom have nchunk once")
        products = self.products(now)
        return np.column_stack([products, products.sum(axis=1)])
