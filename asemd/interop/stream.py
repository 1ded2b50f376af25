"""Analyses of MDAnalysis while a dynamics runs: frames are handed over as they come, and none is kept."""
from __future__ import annotations

from ase.md.md import MolecularDynamics
from ase.units import fs

from asemd.errors import InputError
from asemd.interop.attributes import topology_of
from asemd.interop.frames import frame_of, is_reduced
from asemd.interop.mdanalysis import in_memory, library
from asemd.interop.sources import remembered


class Stream:
    """An observer that shows the atoms of a dynamics to MDAnalysis, frame by frame.

    Parameters
    ----------
    dynamics : asemd.MolecularDynamics or another ase.md dynamics
        The observer attaches itself.
    interval : int
        Steps between frames.

    Attributes
    ----------
    universe : MDAnalysis.Universe
        The atoms at the last frame; its analyses are made of it and given to `feed`.

    Raises
    ------
    InputError
        Something else was given, or MDAnalysis is not installed.

    Notes
    -----
    Each `run` of the dynamics is one trajectory: when it ends, the analyses have the results that ``analysis.run()`` would give of its
    frames. After a run that ended early they have none. An analysis that goes through the frames twice, such as PCA, is refused.

    Examples
    --------
    >>> stream = Stream(md, interval=10)                        # doctest: +SKIP
    >>> rdf = stream.feed(InterRDF(stream.universe.atoms, stream.universe.atoms))
    >>> md.run(1000)
    >>> rdf.results.rdf
    """

    def __init__(self, dynamics: MolecularDynamics, interval: int = 1):
        if not isinstance(dynamics, MolecularDynamics):
            raise InputError(f"a Stream needs a dynamics of ase.md or asemd, got {type(dynamics).__name__}")
        if interval < 1:
            raise InputError(f"a Stream needs an interval of at least one step, got {interval}")
        self.dynamics, self.interval, self.analyses = dynamics, int(interval), []
        self.seen = self.frames = 0         # of the run that goes on
        self._next: tuple[int, int] | None = None
        atoms = dynamics.atoms
        self.reduced = is_reduced(atoms)
        mda = library()
        from asemd.interop.converter import Live
        source = remembered(atoms)
        self.universe = mda.Universe(topology_of(source), to_guess=())
        self.reader = in_memory([frame_of(source, self.reduced)], [source], self.reduced, self._ps(interval * dynamics.dt), Live)
        self.universe.trajectory = self.reader
        dynamics.attach(self, interval=self.interval)

    def _ps(self, time: float) -> float:
        return time if self.reduced else time / (1000.0 * fs)

    def feed(self, analysis):
        """Have an analysis see the frames of the runs to come; returns it.

        Raises
        ------
        InputError
            It is no analysis of MDAnalysis, or one of another universe.
        """
        from MDAnalysis.analysis.base import AnalysisBase
        if not isinstance(analysis, AnalysisBase):
            raise InputError(f"a Stream feeds analyses of MDAnalysis (AnalysisBase), got {type(analysis).__name__}")
        if analysis._trajectory is not self.reader:
            raise InputError(f"{type(analysis).__name__} was made of another universe: make it of the universe of the Stream")
        self.analyses.append(analysis)
        return analysis

    def __call__(self) -> None:
        step, end = self.dynamics.nsteps, self.dynamics.max_steps
        if self._next != (step, end):
            self._begin(step, end)
        self._show()
        for analysis in self.analyses:
            analysis._frame_index, analysis._ts = self.seen, self.reader.ts
            analysis.frames[self.seen], analysis.times[self.seen] = self.reader.ts.frame, self.reader.ts.time
            analysis._single_frame()
        self.seen += 1
        self._next = (step + self.interval, end)
        if self.seen == self.frames:
            self._next = None
            for analysis in self.analyses:
                analysis._conclude()

    def _begin(self, step: int, end: int) -> None:
        """A new run: analyses learn how many frames will come."""
        self.seen, self.frames = 0, end // self.interval - step // self.interval + 1
        self.reader.current, self.reader.n_frames = 0, self.frames
        self._show()
        for analysis in self.analyses:
            analysis._setup_frames(self.reader)
            analysis._prepare()

    def _show(self) -> None:
        """The atoms as they are now become the frame of the universe."""
        atoms, ts = self.dynamics.atoms, self.reader.ts
        frame = frame_of(atoms, self.reduced)
        ts.positions, ts.dimensions = frame.positions, None if frame.cell is None else frame.dimensions
        for name, vectors in (("velocities", frame.velocities), ("forces", frame.forces)):
            setattr(ts, f"has_{name}", vectors is not None)
            if vectors is not None:
                setattr(ts, name, vectors)
        ts.frame = self.reader.current = self.seen
        ts.time = self._ps(self.dynamics.get_time())
        self.reader.sources = [atoms]
