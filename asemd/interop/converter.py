"""What MDAnalysis is given: the converter ``convert_to("ASE")``, registered when this module is imported, and the reader of our frames."""
from __future__ import annotations

from MDAnalysis.converters.base import ConverterBase
from MDAnalysis.coordinates.memory import MemoryReader

from asemd.errors import InputError


class ASEConverter(ConverterBase):
    """``universe.atoms.convert_to("ASE")``, or ``convert_to.ase()``: `asemd.Atoms` of the current frame."""

    lib = "ASE"
    units = {"time": None, "length": "Angstrom"}

    def convert(self, obj):
        """Atoms of a Universe or AtomGroup, see `asemd.interop.mdanalysis.from_mdanalysis`."""
        from asemd.interop.mdanalysis import from_mdanalysis
        return from_mdanalysis(obj)


class Frames(MemoryReader):
    """Frames in memory with the atoms they were made of.

    Parameters
    ----------
    coordinate_array : (frames, n, 3) array
    sources : sequence of asemd.Atoms
        One for each frame, in double precision and in their own orientation.
    reduced : bool
        The numbers are in units lj.
    **kwargs
        As for MemoryReader.
    """

    def __init__(self, coordinate_array, sources=(), reduced=False, **kwargs):
        super().__init__(coordinate_array, **kwargs)
        self.sources, self.reduced = sources, reduced
        self._kwargs |= {"sources": sources, "reduced": reduced}

    @property
    def source(self):
        """The atoms that the current frame was made of."""
        return self.sources[self.ts.frame]


class Live(Frames):
    """One frame, which an observer of a running dynamics replaces: nothing can be read twice or ahead."""

    def __init__(self, *args, **kwargs):
        self.current = 0
        super().__init__(*args, **kwargs)

    @property
    def source(self):
        from asemd.interop.sources import remembered
        return remembered(self.sources[0])

    def copy(self):
        """A frame of its own, which stays as it is."""
        ts = self.ts
        return Frames(ts.positions[None].copy(), [self.source], self.reduced,
                      velocities=ts.velocities[None].copy() if ts.has_velocities else None,
                      forces=ts.forces[None].copy() if ts.has_forces else None, dimensions=ts.dimensions)

    def _reopen(self):
        """The frame stays."""

    def _read_frame(self, i):
        if i != self.current:
            raise InputError(f"frame {i} was asked for while the run is at frame {self.current}: an analysis that reads frames twice or "
                             "out of order cannot be fed during a run; collect the frames and use asemd.to_mdanalysis")
        return self.ts

    def _read_next_timestep(self, ts=None):
        if self.ts.frame == -1:         # the first frame, when the reader is made
            return super()._read_next_timestep(ts)
        return self._read_frame(self.current + 1)
