r"""Time correlation of values, averaged over all pairs of samples.

.. math:: C_{ij}(k\,m) = \frac{p}{n_k} \sum_t a_i(t) \, a_j(t + k\,m)

for :math:`k` = 0 ... Nrepeat - 1, :math:`m` = Nevery steps between samples, :math:`n_k` pairs of samples and prefactor :math:`p`; written
on multiples of Nfreq. With ``ave one`` sums begin anew after each output.

Source: LAMMPS manual, fix ave/correlate. Output: an array with the columns time difference, number of pairs, correlation of each pair of
values; a file.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.output_file import OutputFile
from asemd.fix.sampled import Sampled
from asemd.fix.values import expand, read
from asemd.words import choice, number, take, whole

TYPES = ("auto", "upper", "lower", "auto/upper", "auto/lower", "full", "first")
KEYWORDS = {"type": 1, "ave": 1, "start": 1, "prefactor": 1, "file": 1, "append": 1, "overwrite": 0, "title1": 1, "title2": 1, "title3": 1}


def pairs_of(kind: str, n: int) -> list[tuple[int, int]]:
    """Which values are correlated with which, from 0."""
    every = [(i, j) for i in range(n) for j in range(n)]
    return {"auto": [(i, i) for i in range(n)], "upper": [p for p in every if p[0] < p[1]], "lower": [p for p in every if p[0] > p[1]],
            "auto/upper": [p for p in every if p[0] <= p[1]], "auto/lower": [p for p in every if p[0] >= p[1]], "full": every,
            "first": [p for p in every if p[0] == 0]}[kind]


class AveCorrelate(Sampled):
    """Time correlation of values.

    Parameters
    ----------
    group : str
        Has no effect.
    values : sequence of Compute, (Compute, index) or callable
        Numbers; functions take a `asemd.engine.Snapshot`.
    sample_every, repeat, freq : int
        Steps between samples, number of time differences, steps between outputs.
    type : str
        Which pairs of values: auto, upper, lower, auto/upper, auto/lower, full, first.
    ave : str
        ``one``: begin anew after each output; ``running``.
    start : int
        First step.
    prefactor : float
    file : str, optional

    Raises
    ------
    InputError
        Intervals that do not fit together, a single value without a partner.
    """

    style = "ave/correlate"

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, repeat: int = 1, freq: int = 1, type: str = "auto",
                 ave: str = "one", start: int = 0, prefactor: float = 1.0, file: str = ""):
        super().__init__(group, values, sample_every, repeat, freq, start)
        self.windows, self.ave, self.prefactor = repeat, choice(ave, ("one", "running"), f"fix {self.style} ave"), float(prefactor)
        self.type = choice(type, TYPES, f"fix {self.style} type")
        if not self.values:
            raise InputError(f"fix {self.style} needs at least one value")
        self.pairs = pairs_of(self.type, len(self.values))
        if not self.pairs:
            raise InputError(f"fix {self.style}: type {type} needs at least two values")
        self.overwrite, self.titles, self.path = False, {}, file
        self._first, self._second = np.array(self.pairs).T
        self._clear()
        self.saved_count, self.saved = np.zeros(repeat, np.int64), np.zeros((repeat, len(self.pairs)))
        if file:
            self.file = OutputFile(file, f"fix {self.style}")
            self._header()

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 4, what), ("Nevery", "Nrepeat", "Nfreq")))
        names, rest = sampled.split(words[3:])
        options = sampled.keywords(rest, KEYWORDS, what)
        values = [read(w, session, what).check("scalar", what) for w in expand(names, session)]
        fix = cls(group, values, every, repeat, freq, options.get("type", ["auto"])[0], options.get("ave", ["one"])[0],
                  whole(options.get("start", ["0"])[0], f"{what} start"), number(options.get("prefactor", ["1"])[0], f"{what} prefactor"))
        fix._take(words, options, session)
        return fix

    def _take(self, words, options, session) -> None:
        """What the fixes that correlate read alike."""
        self.session, self.words, self.id = session, list(words), session.defining
        sampled.check_frequencies(self)
        if "overwrite" in options and self.ave != "running":
            raise InputError(f"fix {self.style}: overwrite needs ave running")
        self.overwrite = "overwrite" in options
        self.titles = {n: options[f"title{n}"][0] for n in (1, 2, 3) if f"title{n}" in options}
        self.path = next((options[k][0] for k in reversed(options) if k in ("file", "append")), "")
        self.begin(session.scene.step)
        if self.path:
            self.file = OutputFile(self.path, f"fix {self.style}", "append" in options, session.passive)
            self._header()

    def to_lammps(self) -> list[str]:
        return self.words if hasattr(self, "words") else [str(n) for n in (self.sample_every, self.windows, self.freq)] + [
            *(v.word for v in self.values), "type", self.type]

    def _clear(self) -> None:
        self._history: list[np.ndarray] = []
        self._count, self._sum = np.zeros(self.windows, np.int64), np.zeros((self.windows, len(self.pairs)))

    def first_sample(self, step: int) -> int:
        first = max(step, self.start)
        return -(-first // self.sample_every) * self.sample_every

    def end_of_step(self, loop) -> None:
        """Take a sample, and write the correlations if they are due."""
        snapshot = self.look(loop)
        self.next_sample = loop.step + self.sample_every
        self._add(np.array([v.scalar(snapshot) for v in self.values]))
        if loop.step % self.freq == 0:
            self._conclude(loop.step)

    def _add(self, sample: np.ndarray) -> None:
        self._history.append(sample)
        del self._history[:-self.windows]
        now, n = self._history[-1], len(self._history)
        self._count[:n] += 1
        self._sum[:n] += np.array(self._history)[::-1][:, self._first] * now[self._second]

    def _conclude(self, step: int) -> None:
        self.saved_count = self._count.copy()
        with np.errstate(invalid="ignore", divide="ignore"):
            self.saved = np.where(self._count[:, None] > 0, self.prefactor * self._sum / np.maximum(self._count, 1)[:, None], 0.0)
        if self.file is not None:
            if self.overwrite:
                self.file.rewind()
            text = f"{step} {self.windows}\n"
            for k in range(self.windows):
                cells = "".join(f" {x:g}" for x in self.saved[k]) if self._count[k] else " 0.0" * len(self.pairs)
                text += f"{k + 1} {k * self.sample_every} {self._count[k]}{cells}\n"
            self.file.write(text)
        if self.ave == "one":
            last = self._history[-1]
            self._clear()
            self._add(last)     # the last sample is the first of the next output

    def _header(self) -> None:
        names = " ".join(f"{self.values[i].word}*{self.values[j].word}" for i, j in self.pairs)
        lines = (self.titles.get(1, f"# Time-correlated data for fix {self.id}"),
                 self.titles.get(2, "# Timestep Number-of-time-windows"), self.titles.get(3, f"# Index TimeDelta Ncount {names}"))
        self.file.write("".join(f"{line}\n" for line in lines))
        self.file.mark()

    # ---- outputs
    outputs = ("array",)

    @property
    def size(self) -> int:
        return self.windows

    def array_columns(self) -> int:
        return 2 + len(self.pairs)

    def extensive_at(self, index) -> bool:
        return False

    def array(self, i: int, j: int) -> float:
        """Of time difference `i`: steps, number of pairs of samples, correlations."""
        if not (1 <= i <= self.windows and 1 <= j <= 2 + len(self.pairs)):
            raise InputError(f"fix {self.id} (style {self.style}) has an array of {self.windows} x {2 + len(self.pairs)}, there is no "
                             f"element [{i}][{j}]")
        if j == 1:
            return float((i - 1) * self.sample_every)
        return float(self.saved_count[i - 1]) if j == 2 else float(self.saved[i - 1, j - 3])

    def whole_vector(self, column: int | None = None) -> np.ndarray:
        """A column (from 1) of the array."""
        return np.array([self.array(k, column or 1) for k in range(1, self.windows + 1)])
