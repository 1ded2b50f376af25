r"""Time correlation over many orders of magnitude of time, by a multiple-tau correlator.

Level 0 holds the last Nlen samples; every Ncount samples of a level give, as their mean, one sample of the next, so that the time between
samples grows by Ncount from level to level and Ncorr levels reach times of Nlen Ncount^(Ncorr-1) Nevery steps at constant cost.

Source: Ramirez, Sukumaran, Vorselaars, Likhtman, J. Chem. Phys. 133, 154103 (2010); LAMMPS manual, fix ave/correlate/long.
Output: an array with the columns time and correlation of each pair of values; a file.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.ave_correlate import AveCorrelate
from asemd.fix.values import expand, read
from asemd.words import take, whole

KEYWORDS = {"type": 1, "start": 1, "file": 1, "append": 1, "overwrite": 0, "title1": 1, "title2": 1, "ncorr": 1, "nlen": 1, "ncount": 1}


class AveCorrelateLong(AveCorrelate):
    """Time correlation of values over long times.

    Parameters
    ----------
    group : str
        Has no effect.
    values : sequence of Compute, (Compute, index) or callable
        Numbers; functions take a `asemd.engine.Snapshot`.
    sample_every, freq : int
        Steps between samples, steps between outputs.
    type : str
        As in `asemd.fix.AveCorrelate`.
    ncorr, nlen, ncount : int
        Levels, samples of a level, samples whose mean goes to the next level.
    start : int
    file : str, optional

    Raises
    ------
    InputError
        Intervals or sizes that do not fit together.
    """

    style = "ave/correlate/long"

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, freq: int = 1, type: str = "auto", ncorr: int = 20,
                 nlen: int = 16, ncount: int = 2, start: int = 0, file: str = ""):
        for name, n, least in (("ncorr", ncorr, 1), ("nlen", nlen, 1), ("ncount", ncount, 1)):
            if n < least:
                raise InputError(f"fix {self.style}: {name} must be at least {least}, got {n}")
        if nlen % ncount:
            raise InputError(f"fix {self.style}: nlen {nlen} must be a multiple of ncount {ncount}")
        self.ncorr, self.nlen, self.ncount = ncorr, nlen, ncount
        super().__init__(group, values, sample_every, 1, freq, type, "running", start, 1.0, file)

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        every, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 3, what), ("Nevery", "Nfreq")))
        names, rest = sampled.split(words[2:])
        options = sampled.keywords(rest, KEYWORDS, what)
        values = [read(w, session, what).check("scalar", what) for w in expand(names, session)]
        sizes = {n: whole(options[n][0], f"{what} {n}") for n in ("ncorr", "nlen", "ncount") if n in options}
        start = whole(options.get("start", ["0"])[0], f"{what} start")
        fix = cls(group, values, every, freq, options.get("type", ["auto"])[0], start=start, **sizes)
        fix._take(words, options, session)
        return fix

    def to_lammps(self) -> list[str]:
        return self.words if hasattr(self, "words") else [str(self.sample_every), str(self.freq), *(v.word for v in self.values),
                                                          "type", self.type]

    def _clear(self) -> None:
        shape, n = (self.ncorr, self.nlen), len(self.values)
        self._shift, self._present = np.zeros((*shape, n)), np.zeros(shape, bool)
        self._correlation, self._pairs_seen = np.zeros((*shape, len(self.pairs))), np.zeros(shape, np.int64)
        self._accumulated, self._accumulations = np.zeros((self.ncorr, n)), np.zeros(self.ncorr, np.int64)
        self._newest, self._top = np.zeros(self.ncorr, np.int64), 0
        self.times, self.rows = np.zeros(0), np.zeros((0, len(self.pairs)))

    def _add(self, sample: np.ndarray, level: int = 0) -> None:
        """A sample of a level, and what follows for the levels above it."""
        if level == self.ncorr:
            return
        self._top = max(self._top, level)
        at = self._newest[level]
        self._shift[level, at], self._present[level, at] = sample, True
        self._accumulated[level] += sample
        self._accumulations[level] += 1
        if self._accumulations[level] == self.ncount:
            self._add(self._accumulated[level] / self.ncount, level + 1)
            self._accumulated[level], self._accumulations[level] = 0.0, 0
        first = 0 if level == 0 else self.nlen // self.ncount
        lags = np.arange(first, self.nlen)
        places = (at - lags) % self.nlen
        there = self._present[level, places]
        lags, places = lags[there], places[there]
        self._correlation[level, lags] += self._shift[level, places][:, self._first] * sample[self._second]
        self._pairs_seen[level, lags] += 1
        self._newest[level] = (at + 1) % self.nlen

    def end_of_step(self, loop) -> None:
        """Take a sample, and write the correlations if they are due."""
        snapshot = self.look(loop)
        self.next_sample = loop.step + self.sample_every
        self._add(np.array([v.scalar(snapshot) for v in self.values]))
        if loop.step % self.freq == 0:
            self._evaluate(loop)

    def _evaluate(self, loop) -> None:
        times, rows = [], []
        for level in range(max(self._top, 1)):      # the highest one begins to fill
            first = 0 if level == 0 else self.nlen // self.ncount
            for lag in range(first, self.nlen):
                if self._pairs_seen[level, lag]:
                    times.append(lag * float(self.ncount) ** level * self.sample_every * loop.dt)
                    rows.append(self._correlation[level, lag] / self._pairs_seen[level, lag])
        self.times, self.rows = np.array(times), np.array(rows)
        if self.file is not None:
            if self.overwrite:
                self.file.rewind()
            lines = "".join(f"{t:g} " + "".join(f"{x:g} " for x in row) + "\n" for t, row in zip(times, rows))
            self.file.write(f"# Timestep: {loop.step}\n{lines}")

    def _header(self) -> None:
        names = " ".join(f"{self.values[i].word}*{self.values[j].word}" for i, j in self.pairs)
        lines = (self.titles.get(1, f"# Time-correlated data for fix {self.id}"), self.titles.get(2, f"# Time {names}"))
        self.file.write("".join(f"{line}\n" for line in lines))
        self.file.mark()

    def state(self):
        names = ("_top", "_shift", "_present", "_correlation", "_pairs_seen", "_accumulated", "_accumulations", "_newest", "times", "rows")
        return {name: getattr(self, name) for name in names} | {"next": self.next_sample}

    def restore(self, state):
        self.next_sample = state["next"]
        for name, value in state.items():
            if name != "next":
                if np.shape(value)[1:] != np.shape(getattr(self, name))[1:]:
                    raise InputError(f"fix {self.id} (style {self.style}): the restart file has another number of values or levels")
                setattr(self, name, np.array(value))

    # ---- outputs
    @property
    def size(self) -> int:
        return len(self.times)

    def array_columns(self) -> int:
        return 1 + len(self.pairs)

    def array(self, i: int, j: int) -> float:
        """Row `i`: time, correlations."""
        if not (1 <= i <= len(self.times) and 1 <= j <= 1 + len(self.pairs)):
            raise InputError(f"fix {self.id} (style {self.style}) has {len(self.times)} rows of {1 + len(self.pairs)}, there is no element "
                             f"[{i}][{j}]")
        return float(self.times[i - 1] if j == 1 else self.rows[i - 1, j - 2])

    def whole_vector(self, column: int | None = None) -> np.ndarray:
        """A column (from 1) of the array."""
        return np.array([self.array(k, column or 1) for k in range(1, len(self.times) + 1)])
