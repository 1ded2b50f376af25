r"""Average global values over time.

.. math:: \bar a(t) = \frac{1}{N} \sum_{k=0}^{N-1} a(t - k\,m)

with :math:`N` = Nrepeat samples, :math:`m` = Nevery steps apart, known on multiples of Nfreq; then averaged over all results
(``ave running``) or over the last M of them (``ave window M``).

Source: LAMMPS manual, fix ave/time. Output: a scalar for one number, a vector for several numbers or for one vector, an array for several
vectors; a file.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.output_file import OutputFile, plain
from asemd.fix.sampled import Sampled, Window
from asemd.fix.values import expand, read
from asemd.words import choice, take, whole

KEYWORDS = {"mode": 1, "ave": sampled.ave_count, "start": 1, "off": 1, "file": 1, "append": 1, "overwrite": 0, "format": 1,
            "title1": 1, "title2": 1, "title3": 1}


class AveTime(Sampled):
    """Average global values over time.

    Parameters
    ----------
    group : str
        Has no effect.
    values : sequence of Compute, (Compute, index) or callable
        What is averaged; functions take a `asemd.engine.Snapshot`.
    sample_every, repeat, freq : int
        Steps between samples, samples of an average, steps between averages.
    mode : str
        ``scalar``: each value is one number; ``vector``: each value is a vector.
    ave : str
        ``one``, ``running``, ``window``.
    window : int
        How many averages ``window`` covers.
    start : int
        First step.
    off : sequence of int
        Values, from 1, that are not averaged: the last sample is taken.
    file : str, optional
        Written on multiples of `freq`.

    Raises
    ------
    InputError
        Intervals that do not fit together, a value of the other kind.
    """

    style = "ave/time"

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, repeat: int = 1, freq: int = 1, mode: str = "scalar",
                 ave: str = "one", window: int = 0, start: int = 0, off=(), file: str = ""):
        super().__init__(group, values, sample_every, repeat, freq, start)
        if not self.values:
            raise InputError("fix ave/time needs at least one value")
        self.mode = choice(mode, ("scalar", "vector"), "fix ave/time mode")
        for k in off:
            if not 1 <= k <= len(self.values):
                raise InputError(f"fix ave/time: off {k}: there are {len(self.values)} values")
        self.off = [k in off for k in range(1, len(self.values) + 1)]
        self.window = Window(ave, window)
        self.overwrite, self.format, self.titles = False, " %g", {}
        self._sum = None
        self.result: np.ndarray | None = None       # (values,) or (rows, values)
        self.rows = 0
        self.path = file
        if file:
            self.file = OutputFile(file, "fix ave/time")
            self._header()

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix ave/time"
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 3, what), ("Nevery", "Nrepeat", "Nfreq")))
        names, rest = sampled.split(words[3:])
        options = sampled.keywords(rest, KEYWORDS, what)
        off = [whole(rest[k + 1], f"{what} off") for k, w in enumerate(rest[:-1]) if w == "off"]
        mode = choice(options.get("mode", ["scalar"])[0], ("scalar", "vector"), f"{what} mode")
        if not names:
            raise InputError(f"{what} needs at least one value after Nfreq")
        values = [read(w, session, what).check(mode, what) for w in expand(names, session, vectors=mode == "vector")]
        ave, window = sampled.read_ave(options.get("ave", ["one"]), what)
        fix = cls(group, values, every, repeat, freq, mode, ave, window, whole(options.get("start", ["0"])[0], f"{what} start"), off)
        fix.session, fix.words = session, list(words)
        sampled.check_frequencies(fix)
        if len({v.extensive(mode) for v in values}) > 1 and mode == "vector" and len(values) > 1:
            raise InputError(f"{what}: columns that grow with the system and columns that do not cannot be in one array")
        if "overwrite" in options and ave != "running":
            raise InputError(f"{what}: overwrite needs ave running")
        fix.overwrite, fix.format = "overwrite" in options, options.get("format", [" %g"])[0]
        fix.titles = {n: options[f"title{n}"][0] for n in (1, 2, 3) if f"title{n}" in options}
        fix.id = getattr(session, "defining", "")
        fix.path = next((options[k][0] for k in reversed(options) if k in ("file", "append")), "")
        fix.begin(session.scene.step)
        if fix.path:
            fix.file = OutputFile(fix.path, what, "append" in options, session.passive)
            fix._header()
        return fix

    def to_lammps(self) -> list[str]:
        return self.words if hasattr(self, "words") else [str(n) for n in (self.sample_every, self.repeat, self.freq)] + [
            v.word for v in self.values]

    # ---- samples
    def sample(self, snapshot) -> None:
        if self.mode == "scalar":
            now = np.array([v.scalar(snapshot) for v in self.values])
        else:
            columns = [v.vector(snapshot) for v in self.values]
            if len({len(c) for c in columns}) > 1:
                raise InputError(f"fix {self.id} (style ave/time): vectors of different lengths: "
                                 + ", ".join(f"{v.word} has {len(c)}" for v, c in zip(self.values, columns)))
            now = np.column_stack(columns)
        if self.count == 0:
            self._sum = now.copy()
        else:
            if self._sum.shape != now.shape:
                raise InputError(f"fix {self.id} (style ave/time): the number of rows changed from {len(self._sum)} to {len(now)}")
            self._sum = np.where(self.off, now, self._sum + now)

    def conclude(self, step: int) -> None:
        average = np.where(self.off, self._sum, self._sum / self.repeat)
        if self.window.mode != "one" and np.shape(self.window.total) not in ((), average.shape):
            raise InputError(f"fix {self.id} (style ave/time): the number of rows changed, ave {self.window.mode} needs the same number")
        whole_window = self.window.add(average)
        self.result = np.where(self.off, average, whole_window)
        self.rows = len(self.result) if self.mode == "vector" else 0
        self._write(step)

    # ---- file
    @property
    def _yaml(self) -> bool:
        return self.path.endswith((".yaml", ".yml"))

    def _header(self) -> None:
        words = [v.word for v in self.values]
        vector = self.mode == "vector"
        lines = [self.titles.get(1, f"# Time-averaged data for fix {self.id}"),
                 self.titles.get(2, f"# TimeStep {'Number-of-rows' if vector else ' '.join(words)}")]
        if vector:
            lines.append(self.titles.get(3, f"# Row {' '.join(words)}"))
        self.file.write("".join(f"{line}\n" for line in lines))
        if self._yaml:
            names = "".join(f"'{w}', " for w in ([] if vector else ["Step"]) + words)
            self.file.write(f"---\nkeywords: [{names}]\ndata:\n", "...\n")
        self.file.mark()

    def _write(self, step: int) -> None:
        if self.file is None:
            return
        if self.overwrite:
            self.file.rewind()
        if self._yaml:
            def cells(row):
                return "".join(f"{plain(x)}, " for x in row)
            if self.mode == "scalar":
                text = f"  - [{step}, {cells(self.result)}]\n"
            else:
                text = f"  {step}:\n" + "".join(f"  - [{cells(row)}]\n" for row in self.result)
        elif self.mode == "scalar":
            text = f"{step}" + "".join(self.format % x for x in self.result) + "\n"
        else:
            text = f"{step} {len(self.result)}\n" + "".join(
                f"{k}" + "".join(self.format % x for x in row) + "\n" for k, row in enumerate(self.result, 1))
        self.file.write(text, "...\n" if self._yaml else "")

    # ---- outputs
    @property
    def outputs(self) -> tuple[str, ...]:
        one = len(self.values) == 1
        return ("scalar",) if self.mode == "scalar" and one else ("array",) if self.mode == "vector" and not one else ("vector",)

    @property
    def size(self) -> int:
        """Elements of the vector, rows of the array."""
        if self.mode == "scalar":
            return len(self.values)
        return self.rows or sampled.length_of(self.values[0])

    def array_columns(self) -> int:
        return len(self.values)

    def extensive_at(self, index) -> bool:
        return self.values[index[-1] - 1 if index and (self.mode == "scalar" or len(index) == 2) else 0].extensive(self.mode)

    def scalar(self) -> float:
        """The average of the only value."""
        return float(self.result[0]) if self.result is not None and "scalar" in self.outputs else 0.0 if "scalar" in self.outputs \
            else super().scalar()

    def vector(self, i: int) -> float:
        if "vector" not in self.outputs:
            return super().vector(i)
        if self.result is None:
            return 0.0 if 1 <= i <= max(self.size, 1) else self._beyond(i)
        values = self.result if self.mode == "scalar" else self.result[:, 0]
        return float(values[i - 1]) if 1 <= i <= len(values) else self._beyond(i)

    def array(self, i: int, j: int) -> float:
        if "array" not in self.outputs:
            raise InputError(f"fix {self.id} (style ave/time) has no global array")
        if not 1 <= j <= len(self.values):
            return self._beyond(i, j)
        if self.result is None:
            return 0.0
        return float(self.result[i - 1, j - 1]) if 1 <= i <= len(self.result) else self._beyond(i, j)

    def _beyond(self, *index: int):
        raise InputError(f"fix {self.id} (style ave/time) has no element {''.join(f'[{i}]' for i in index)}")
