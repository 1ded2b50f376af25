r"""Histogram of values, averaged over time.

Bin :math:`k` of :math:`N` counts the values in :math:`[lo + (k-1) w, lo + k w)` with :math:`w = (hi - lo) / N`; the counts
of Nrepeat samples are added. Values outside are left out (``beyond ignore``), counted in the first and last bin (``end``) or in two more
bins (``extra``).

Source: LAMMPS manual, fix ave/histo. Output: a vector of 4 (values counted, values left out, smallest and largest value), an array of 3
columns (coordinate of the bin, count, fraction); a file.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.output_file import OutputFile, plain
from asemd.fix.sampled import Sampled, Window
from asemd.fix.values import ATOM_WORDS, expand, read
from asemd.kernels import observe
from asemd.words import choice, number, take, whole

KEYWORDS = {"mode": 1, "file": 1, "append": 1, "ave": sampled.ave_count, "start": 1, "beyond": 1, "overwrite": 0, "kind": 1,
            "title1": 1, "title2": 1, "title3": 1}
BIG = 1.0e20
BEYOND = ("ignore", "end", "extra")
KINDS = {"global": "vector", "peratom": "per_atom", "local": "local"}


class AveHisto(Sampled):
    """Histogram of values over time.

    Parameters
    ----------
    group : str
        The atoms whose values are counted.
    values : sequence of str, Compute, (Compute, index) or callable
        What is counted; in Python each gives an array, or numbers with ``mode="scalar"``.
    lo, hi : float
        Range of the bins.
    bins : int
    sample_every, repeat, freq : int
        Steps between samples, samples of a histogram, steps between histograms.
    mode : str
        ``scalar``: each value is one number; ``vector``: many (global vectors, values per atom or local values as `kind` says).
    kind : str
        ``global``, ``peratom``, ``local``; for mode vector.
    beyond : str
        ``ignore``, ``end``, ``extra``.
    ave, window, start, file
        As in `asemd.fix.AveTime`.

    Raises
    ------
    InputError
        Intervals that do not fit together, an empty range.
    """

    style = "ave/histo"
    weighted = False

    def __init__(self, group: str = "all", values=(), lo: float = 0.0, hi: float = 1.0, bins: int = 10, sample_every: int = 1,
                 repeat: int = 1, freq: int = 1, mode: str = "vector", kind: str = "peratom", beyond: str = "ignore", ave: str = "one",
                 window: int = 0, start: int = 0, file: str = ""):
        super().__init__(group, values, sample_every, repeat, freq, start)
        what = f"fix {self.style}"
        if not self.values:
            raise InputError(f"{what} needs at least one value")
        if not lo < hi:
            raise InputError(f"{what}: lo {lo:g} must be below hi {hi:g}")
        if bins < 1:
            raise InputError(f"{what}: there must be at least 1 bin, got {bins}")
        if self.weighted and len(self.values) != 2:
            raise InputError(f"{what} needs two values, what is counted and its weights, got {len(self.values)}")
        self.mode, self.kind = choice(mode, ("scalar", "vector"), f"{what} mode"), choice(kind, KINDS, f"{what} kind")
        self.beyond = choice(beyond, BEYOND, f"{what} beyond")
        self.lo, self.hi, self.inner = lo, hi, bins
        width = (hi - lo) / bins
        self.bins = bins + 2 * (beyond == "extra")
        self.coordinate = lo + (np.arange(bins) + 0.5) * width
        if beyond == "extra":
            self.coordinate = np.concatenate([[lo], self.coordinate, [hi]])
        self.width = width
        self.window = Window(ave, window)
        self.ave, self.extremes = ave, []
        self.overwrite, self.titles, self.path = False, {}, file
        self._counts, self._stats = np.zeros(self.bins), np.array([0.0, 0.0, BIG, -BIG])
        self.stats, self.counts = np.zeros(4), np.zeros(self.bins)
        self.begun = False
        if file:
            self.file = OutputFile(file, what)
            self._header()

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        take(words, 7, what)
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(words, ("Nevery", "Nrepeat", "Nfreq")))
        lo, hi, bins = number(words[3], f"{what} lo"), number(words[4], f"{what} hi"), whole(words[5], f"{what} Nbin")
        names, rest = sampled.split(words[6:], ATOM_WORDS)
        options = sampled.keywords(rest, KEYWORDS, what)
        mode = options.get("mode", ["scalar"])[0]
        names = expand(names, session, vectors=mode == "vector")
        values = [read(w, session, what, ATOM_WORDS) for w in names]
        if not values:
            raise InputError(f"{what} needs at least one value after Nbin")
        kind = cls._kind(values, mode, options.get("kind", [""])[0], what)
        for value in values:
            value.check("scalar" if mode == "scalar" else KINDS[kind], what)
        ave, window = sampled.read_ave(options.get("ave", ["one"]), what)
        fix = cls(group, values, lo, hi, bins, every, repeat, freq, mode, kind, options.get("beyond", ["ignore"])[0], ave, window,
                  whole(options.get("start", ["0"])[0], f"{what} start"))
        fix.session, fix.words = session, list(words)
        sampled.check_frequencies(fix)
        if "overwrite" in options and ave != "running":
            raise InputError(f"{what}: overwrite needs ave running")
        fix.overwrite = "overwrite" in options
        fix.titles = {n: options[f"title{n}"][0] for n in (1, 2, 3) if f"title{n}" in options}
        fix.id = session.defining
        fix.path = next((options[k][0] for k in reversed(options) if k in ("file", "append")), "")
        fix.begin(session.scene.step)
        if fix.path:
            fix.file = OutputFile(fix.path, what, "append" in options, session.passive)
            fix._header()
        return fix

    @staticmethod
    def _kind(values, mode: str, asked: str, what: str) -> str:
        """Where the values come from: what all of them have."""
        if asked:
            return choice(asked, KINDS, f"{what} kind")
        if mode == "scalar":
            if any(v.kind == "atom" or not v.gives("scalar") and v.gives("per_atom") for v in values):
                raise InputError(f"{what} cannot process per-atom values in scalar mode: add mode vector")
            return "global"
        common = [k for k, name in KINDS.items() if all(v.gives(name) for v in values)]
        if not common:
            raise InputError(f"{what}: the values must all be global, all per atom or all local: {' '.join(v.word for v in values)}")
        return common[0]

    def to_lammps(self) -> list[str]:
        if hasattr(self, "words"):
            return self.words
        return [*(str(n) for n in (self.sample_every, self.repeat, self.freq)), repr(self.lo), repr(self.hi), str(self.inner),
                *(v.word for v in self.values), "mode", self.mode]

    # ---- samples
    def _numbers(self, value, snapshot) -> np.ndarray:
        if self.mode == "scalar":
            return np.array([value.scalar(snapshot)])
        if self.kind == "global":
            return value.vector(snapshot)
        if self.kind == "local":
            return value.local(snapshot)
        mask = snapshot.mask(self.group)
        return value.per_atom(snapshot) if mask.all() else value.per_atom(snapshot)[mask]

    def sample(self, snapshot) -> None:
        if self.count == 0:
            self._counts[:], self._stats[:] = 0.0, (0.0, 0.0, BIG, -BIG)
        columns = [np.ascontiguousarray(self._numbers(v, snapshot)) for v in self.values]
        if self.weighted and len(columns[0]) != len(columns[1]):
            raise InputError(f"fix {self.id} (style {self.style}): {len(columns[0])} values but {len(columns[1])} weights")
        weights = columns[1] if self.weighted else np.zeros(0)
        for values in columns[:1] if self.weighted else columns:
            observe.histogram(values, weights, self.lo, self.hi, 1.0 / self.width, self.inner, BEYOND.index(self.beyond), self._counts,
                              self._stats)

    def conclude(self, step: int) -> None:
        now = np.concatenate([self._stats[:2], self._counts])
        self.window.add(now)
        self.extremes = (self.extremes if self.ave != "one" else []) + [self._stats[2:].copy()]
        if self.ave == "window":
            self.extremes = self.extremes[-self.window.size:]
        elif self.ave == "running":
            every = np.array(self.extremes)
            self.extremes = [np.array([every[:, 0].min(), every[:, 1].max()])]
        total, every = np.asarray(self.window.total), np.array(self.extremes)
        self.stats = np.array([total[0], total[1], every[:, 0].min(), every[:, 1].max()])
        self.counts = total[2:].copy()
        self.begun = True
        self._write(step)

    # ---- file
    def _header(self) -> None:
        lines = (self.titles.get(1, f"# Histogrammed data for fix {self.id}"),
                 self.titles.get(2, "# TimeStep Number-of-bins Total-counts Missing-counts Min-value Max-value"),
                 self.titles.get(3, "# Bin Coord Count Count/Total"))
        self.file.write("".join(f"{line}\n" for line in lines))
        self.file.mark()

    def _write(self, step: int) -> None:
        if self.file is None:
            return
        if self.overwrite:
            self.file.rewind()
        text = f"{step} {self.bins} {' '.join(plain(s) for s in self.stats)}\n"
        for k, row in enumerate(np.column_stack([self.coordinate, self.counts, self._fractions()]), 1):
            text += f"{k} {row[0]:g} {row[1]:g} {row[2]:g}\n"
        self.file.write(text)

    def _fractions(self) -> np.ndarray:
        return self.counts / self.stats[0] if self.stats[0] != 0.0 else np.zeros(self.bins)

    # ---- outputs
    @property
    def size(self) -> int:
        return 4

    def extensive_at(self, index) -> bool:
        return False

    def array_columns(self) -> int:
        return 3

    def vector(self, i: int) -> float:
        """Values counted, values left out, smallest value, largest value."""
        if not 1 <= i <= 4:
            raise InputError(f"fix {self.id} (style {self.style}) has a vector of 4, there is no element {i}")
        return float(self.stats[i - 1])

    def array(self, i: int, j: int) -> float:
        """Of bin `i`: its coordinate, count, fraction of all."""
        if not (1 <= i <= self.bins and 1 <= j <= 3):
            raise InputError(f"fix {self.id} (style {self.style}) has an array of {self.bins} x 3, there is no element [{i}][{j}]")
        if j == 1:
            return float(self.coordinate[i - 1])
        return float(self.counts[i - 1] if j == 2 else self._fractions()[i - 1])

    def whole_vector(self, column: int | None = None) -> np.ndarray:
        """The vector, or a column (from 1) of the array."""
        count = 4 if column is None else self.bins
        return np.array([self.vector(k) if column is None else self.array(k, column) for k in range(1, count + 1)])
