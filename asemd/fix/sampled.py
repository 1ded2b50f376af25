"""What fixes that average have in common: when they sample, and the keywords of their command."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from asemd.errors import InputError, nearest
from asemd.fix import NEVER, Fix
from asemd.fix.output_file import OutputFile
from asemd.fix.values import given, snapshot_of
from asemd.words import choice, whole


class Sampled(Fix):
    """A fix that looks at values on `repeat` steps, `every` steps apart, the last of which is a multiple of `freq`.

    Parameters
    ----------
    group : str
    values : sequence of Value, Compute, (Compute, index) or callable
    sample_every, repeat, freq : int
        Nevery, Nrepeat, Nfreq of LAMMPS.
    start : int
        No sample before this step.

    Raises
    ------
    InputError
        Nfreq is not a multiple of Nevery, or Nrepeat samples do not fit.
    """

    observes: ClassVar[bool] = True
    overlaps: ClassVar[bool] = False        # whether results may have samples in common
    session: Any = None
    file: OutputFile | None = None

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, repeat: int = 1, freq: int = 1, start: int = 0):
        super().__init__(group)
        what = f"fix {self.style}"
        for name, n in (("Nevery", sample_every), ("Nrepeat", repeat), ("Nfreq", freq)):
            if n < 1:
                raise InputError(f"{what}: {name} must be at least 1, got {n}")
        if freq % sample_every or (sample_every * repeat > freq and not self.overlaps):
            least = "" if self.overlaps else f", and at least Nevery * Nrepeat = {sample_every * repeat}"
            raise InputError(f"{what}: Nfreq {freq} must be a multiple of Nevery {sample_every}{least}")
        self.values = [given(v, k) for k, v in enumerate(values, 1)]
        self.sample_every, self.repeat, self.freq, self.start = sample_every, repeat, freq, start
        self.next_sample: int | None = None
        self.count = 0          # samples since the last result

    @property
    def output_every(self) -> int:
        """Steps between two results: others that use them must ask on multiples of it."""
        return self.freq

    def begin(self, step: int) -> None:
        """Choose the first step with a sample."""
        self.next_sample = self.first_sample(step)

    def first_sample(self, step: int) -> int:
        """The first step from `step` on with a sample of a complete average."""
        due = (step // self.freq + 1) * self.freq
        while due < self.start:
            due += self.freq
        due = step if due - self.freq == step and self.repeat == 1 else due - (self.repeat - 1) * self.sample_every
        return due + self.freq if due < step else due

    def next_end(self, step: int) -> int:
        return self.next_sample if self.next_sample is not None and self.next_sample > step else NEVER

    def setup(self, loop) -> None:
        if self.next_sample is None:
            self.begin(loop.step)
        self.needs = frozenset().union(*(v.needs() for v in self.values))
        if loop.step > self.next_sample:
            raise InputError(f"fix {self.id} (style {self.style}): the timestep went beyond step {self.next_sample}, its next sample: "
                             "unfix it before reset_timestep")
        if self.next_sample == loop.step:
            self.end_of_step(loop)

    def look(self, loop):
        """The snapshot of this step."""
        return snapshot_of(loop, self.session, self.needs)

    def end_of_step(self, loop) -> None:
        """Take a sample; after the last one of an average, the result."""
        self.sample(self.look(loop))
        self.count += 1
        if self.count < self.repeat:
            self.next_sample = loop.step + self.sample_every
            return
        self.count = 0
        self.next_sample = loop.step + self.freq - (self.repeat - 1) * self.sample_every
        self.conclude(loop.step)

    def sample(self, snapshot) -> None:
        """Add the values of this step."""
        raise NotImplementedError

    def conclude(self, step: int) -> None:
        """All samples are there."""
        raise NotImplementedError


def check_frequencies(fix: Sampled) -> None:
    """Refuse fixes as inputs whose results do not change on the steps that are asked for."""
    for value in fix.values:
        if value.kind == "f":
            other = fix.session.variables.provider.source("f", value.id)
            every = getattr(other, "output_every", 1)
            if fix.sample_every % every:
                raise InputError(f"fix {fix.style}: {value.word} is known on multiples of {every} steps only, "
                                 f"Nevery {fix.sample_every} is none")


def keywords(words: list[str], table: Mapping[str, int | Callable[[list[str]], int]], what: str) -> dict[str, list[str]]:
    """Keyword -> its values; `table` says how many each has.

    Raises
    ------
    InputError
        An unknown keyword, or too few values.
    """
    out: dict[str, list[str]] = {}
    words = list(words)
    while words:
        keyword = words.pop(0)
        if keyword not in table:
            raise InputError(f"{what}: unknown keyword {keyword!r}{nearest(keyword, table)}")
        count = table[keyword]
        count = count(words) if callable(count) else count
        if len(words) < count:
            raise InputError(f"{what}: {keyword} needs {count} value{'s' * (count != 1)}, got {len(words)}")
        out[keyword], words = words[:count], words[count:]
    return out


def ave_count(words: list[str]) -> int:
    """``ave`` has one value, ``ave window`` two."""
    return 2 if words[:1] == ["window"] else 1


def read_ave(words: list[str], what: str) -> tuple[str, int]:
    """``one``, ``running``, ``window M``."""
    mode = choice(words[0], ("one", "running", "window"), f"{what} ave")
    window = whole(words[1], f"{what} ave window") if mode == "window" else 0
    if mode == "window" and window < 1:
        raise InputError(f"{what}: ave window needs at least 1 value, got {window}")
    return mode, window


def is_value(word: str, names=()) -> bool:
    """Whether a word is one of the values, which come before the keywords."""
    return word[:2] in ("c_", "f_", "v_") or word in names


def split(words: list[str], names=()) -> tuple[list[str], list[str]]:
    """Values, and what comes after them."""
    k = 0
    while k < len(words) and is_value(words[k], names):
        k += 1
    return words[:k], words[k:]


class Window:
    """Averages of averages: ``one``, ``running`` over all, or over the last `size` of them."""

    def __init__(self, mode: str = "one", size: int = 0):
        self.mode, self.size = mode, size
        self.history: list = []
        self.total, self.norm = 0.0, 0

    def add(self, value):
        """Take a new average (number or array); the sum over the window is in `total`, their number in `norm`."""
        if self.mode == "one":
            self.total, self.norm = value + 0.0, 1
        elif self.mode == "running":
            self.total, self.norm = self.total + value, self.norm + 1
        else:
            self.total = self.total + value
            if len(self.history) == self.size:
                self.total = self.total - self.history.pop(0)
            self.history.append(value + 0.0)
            self.norm = len(self.history)
        return self.total / self.norm


def length_of(value) -> int:
    """How many elements a vector has, as far as that is known before a run; else 0."""
    if value.kind == "python":
        return 0
    try:
        return value.session.variables.provider.vector_length(value.kind, value.id)
    except InputError:
        return 0
