r"""Chunks: a number for each atom, which says with which others it belongs together. Other computes (com/chunk ...) sum over them.

Styles: type; molecule; bin/1d dim origin delta, bin/2d, bin/3d (dim origin delta for each direction); bin/sphere x y z rmin rmax nbins;
bin/cylinder dim origin delta c1 c2 rmin rmax nbins (c1, c2 and radii are never in lattice spacings); c_ID, c_ID[k], f_ID, f_ID[k], v_name
(values are cut to whole numbers). Origins are lower, center, upper or a coordinate. Keywords: ``region ID``; ``nchunk once|every``;
``limit N max|exact``; ``ids once|nfreq|every``; ``compress yes|no`` (numbers without atoms are left out); ``discard yes|no|mixed`` (atoms
with numbers beyond: not in a chunk, or in the first or last one; mixed: as ``no`` at the faces of the box, as ``yes`` at a ``bound``);
``bound x|y|z lo hi``; ``pbc yes|no`` (distances of bin/sphere and bin/cylinder to the closest image); ``units lattice|box|reduced``. Atoms
that are in no chunk have 0. Of the spheres and cylinders of ``units reduced`` the radii grow with the box along its first direction.

Source: LAMMPS manual, compute chunk/atom. Units: none.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._bins import Frame
from asemd.compute._chunk_words import Settings, read, write
from asemd.compute._original import Original
from asemd.errors import InputError
from asemd.kernels import observe


class ChunkAtom(Compute):
    """Chunks.

    Parameters
    ----------
    group : str
        Atoms outside are in no chunk.
    settings : asemd.compute._chunk_words.Settings
        How atoms are numbered.

    Raises
    ------
    InputError
        Settings that do not go together.
    """

    style = "chunk/atom"

    def __init__(self, group: str = "all", settings: Settings | None = None):
        super().__init__(group)
        self.settings = settings or Settings("type")
        self.ids: np.ndarray | None = None      # of compressed chunks
        self.fixed: tuple | None = None         # number of chunks and ids, with nchunk once
        self.assigned: Original | None = None   # chunks of atoms, with ids once
        self._just: tuple | None = None         # a state and its `numbers`
        self.held = 0       # how many fixes want the number of chunks, and with ids nfreq the chunks of atoms, to stay

    @property
    def needs(self) -> frozenset[str]:
        return self.settings.source.needs if self.settings.source else frozenset()

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, read(words, session))

    def to_lammps(self) -> list[str]:
        return write(self.settings)

    @property
    def counts_once(self) -> bool:
        """Whether the number of chunks is that of the first time."""
        s = self.settings
        if s.nchunk:
            return s.nchunk == "once"
        return not s.compress and (s.style == "type" or s.style == "molecule" and s.region is None or bool(s.bins) and s.units == "reduced")

    def hold(self, state) -> None:
        """The number of chunks, and with ``ids nfreq`` the chunks of atoms, stay as now until `release`; for fixes that average."""
        if not self.held:
            self.fixed = self.assigned = None if not self.counts_once else self.fixed
            just = self._just = state, self.numbers(state)
            self.assign(state)
            self._just = just       # the first sample may be of the same step
        self.held += 1

    def release(self) -> None:
        """See `hold`."""
        self.held -= 1

    def setup(self, state) -> None:
        """At the start of a run: what is found once is found."""
        self.assign(state)

    def numbers(self, state) -> tuple[np.ndarray, np.ndarray, int]:
        """(n,) number of each atom as its style has it, (n,) whether it can be in a chunk, and how many numbers there are."""
        s, system = self.settings, state.system
        known = state.mask(self.group)
        if s.region is not None:
            known = known & s.region.inside(system.x)
        if s.bins:
            at, inside, total = s.bins.assign(Frame(system, s.units == "reduced"), s.bounds, s.discard, s.pbc)
            at += 1
            inside &= known
            return at, inside, total
        if s.style == "type":
            return system.type.astype(np.int64), known, system.counts["ntypes"]
        if s.style == "molecule":
            at = system.molecule.astype(np.int64, copy=False)
        else:
            at = np.trunc(s.source.per_atom(state)).astype(np.int64)
        return at, known, max(int((at if known.all() else at[known]).max(initial=0)), 0)

    def _count(self, at: np.ndarray, known: np.ndarray, total: int) -> tuple[int, np.ndarray | None]:
        """How many chunks there are, and the numbers that they are if some are left out."""
        s, count, ids = self.settings, total, None
        limit = s.limit if not s.bins else 0
        if limit and not s.compress:
            count = limit if s.exact else min(count, limit)
        elif limit and s.limit_first:
            count = min(count, limit)
        if s.compress:
            ids = np.unique(at[known & (at <= count)])
            count = len(ids)
            if limit and not s.limit_first:
                count = limit if s.exact else min(count, limit)
                ids = ids[:count]
        return count, ids

    def assign(self, state) -> tuple[np.ndarray, int]:
        """(n,) chunk of each atom from 1 on, 0 for none; and how many there are."""
        s, just, self._just = self.settings, self._just, None
        if self.assigned is not None and self.fixed is not None and (s.ids == "once" or s.ids == "nfreq" and self.held):
            self.ids = self.fixed[1]
            return self.assigned.of(state.system, np.zeros(state.system.n, int)), self.fixed[0]
        at, known, total = just[1] if just is not None and just[0] is state else self.numbers(state)
        stays = self.counts_once or self.held > 0
        if self.fixed is None or not stays:
            self.fixed = self._count(at, known, total)
        count, self.ids = self.fixed
        if self.ids is not None:
            place = np.searchsorted(self.ids, at)
            found = (place < len(self.ids)) & (self.ids[np.minimum(place, max(len(self.ids) - 1, 0))] == at) if len(self.ids) else at < at
            at = np.where(found, place + 1, count if s.discard == "no" and not s.bins else 0)
        elif s.discard == "no" and not s.bins:
            at = np.where((at < 1) | (at > count), count, at)
        chunk = np.empty(len(at), np.int64)
        observe.within(at, known, count, chunk)
        at = chunk
        if s.ids in ("once", "nfreq"):
            self.assigned = Original(state.system, at)
        return at, count

    def per_atom(self, state) -> np.ndarray:
        """(n,) chunk of each atom, 0 for none."""
        return self.assign(state)[0].astype(float)

    def scalar(self, state) -> float:
        """How many chunks there are."""
        return float(self.assign(state)[1])

    def _number(self, state) -> int:
        """How many chunks there are; while they are held, no atom is assigned for it."""
        return self.fixed[0] if self.held and self.fixed is not None else self.assign(state)[1]

    def numbers_of_chunks(self, state) -> np.ndarray:
        """(chunks,) what each was numbered before numbers without atoms were left out."""
        count = self._number(state)
        return np.arange(1, count + 1) if self.ids is None else np.pad(self.ids, (0, count - len(self.ids)))

    def coordinates(self, state) -> np.ndarray:
        """(chunks, directions) the middles of bins.

        Raises
        ------
        InputError
            Chunks that are no bins.
        """
        s = self.settings
        if not s.bins:
            raise InputError(f"compute {self.id} (chunk/atom {s.style}) has no bins with coordinates")
        count = self._number(state)
        middles = s.bins.middles(Frame(state.system, s.units == "reduced"), s.bounds)
        return middles[self.ids - 1] if self.ids is not None else middles[:count]
