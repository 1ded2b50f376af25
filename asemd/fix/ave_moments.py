r"""Mean, standard deviation, variance, skewness and excess kurtosis of values over time.

.. math:: s^2 = \frac{\sum (a - \bar a)^2}{N - 1}, \qquad
          G_1 = \frac{\sqrt{N (N - 1)}}{N - 2} \frac{m_3}{m_2^{3/2}}, \qquad
          G_2 = \frac{N - 1}{(N - 2)(N - 3)} \left( (N + 1) \left( \frac{m_4}{m_2^2} - 3 \right) + 6 \right)

of the last N = Nrepeat samples, Nevery steps apart, with central moments :math:`m_k`; known on multiples of Nfreq. With Nevery * Nrepeat
above Nfreq results have samples in common, and the first ones are of as many as there are. As in LAMMPS results are 0 as long as there are
fewer than three samples. What is not defined for so few samples, or samples that are all equal, is nan.

Source: LAMMPS, fix ave/moments (2025). Output: a vector, for each value all moments in the order they are named; an array whose columns
are the last M results (``history M``, by default 1), the newest first.
"""
from __future__ import annotations

from collections import deque

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.sampled import Sampled
from asemd.fix.values import expand, read
from asemd.words import take, whole

MOMENTS = ("mean", "stddev", "variance", "skew", "kurtosis")
KEYWORDS = {"start": 1, "history": 1}


def moment(name: str, a: np.ndarray) -> float:
    """One of `MOMENTS` of samples (N,)."""
    n, mean = len(a), a.mean()
    m2, m3, m4 = (float(((a - mean) ** k).mean()) for k in (2, 3, 4))
    if name == "mean":
        return float(mean)
    if name in ("stddev", "variance"):
        variance = m2 * n / (n - 1) if n > 1 else np.nan
        return float(np.sqrt(variance)) if name == "stddev" else variance
    if m2 == 0.0 or n < (3 if name == "skew" else 4):
        return float("nan")
    if name == "skew":
        return float(np.sqrt(n * (n - 1.0)) / (n - 2) * m3 / m2**1.5)
    return (n - 1) / ((n - 2) * (n - 3)) * ((n + 1) * (m4 / m2**2 - 3.0) + 6.0)


class AveMoments(Sampled):
    """Moments of values over time.

    Parameters
    ----------
    group : str
        Has no effect.
    values : sequence of Compute, (Compute, index) or callable
        Numbers; functions take a `asemd.engine.Snapshot`.
    moments : sequence of str
        Some of mean, stddev, variance, skew, kurtosis.
    sample_every, repeat, freq : int
        Steps between samples, samples of a result, steps between results (a multiple of the first).
    history : int
        How many results are kept.
    start : int
        First step.

    Raises
    ------
    InputError
        Intervals that do not fit together, no value, no moment, values that grow with the system together with such that do not.
    """

    style = "ave/moments"
    overlaps = True

    def __init__(self, group: str = "all", values=(), moments=("mean", "stddev"), sample_every: int = 1, repeat: int = 1, freq: int = 1,
                 history: int = 1, start: int = 0):
        super().__init__(group, values, sample_every, repeat, freq, start)
        what = f"fix {self.style}"
        if not self.values:
            raise InputError(f"{what} needs at least one value")
        if not moments or set(moments) - set(MOMENTS):
            raise InputError(f"{what} needs moments out of {' '.join(MOMENTS)}, got {' '.join(moments) or 'none'}")
        if len({v.extensive() for v in self.values}) > 1:
            raise InputError(f"{what}: values that grow with the system and values that do not cannot be in one array")
        if history < 1:
            raise InputError(f"{what}: history must be at least 1, got {history}")
        self.moments, self.history = tuple(moments), history
        self.results: list[np.ndarray] = []     # newest first
        self._samples: deque[list[float]] = deque(maxlen=repeat)

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 5, what), ("Nevery", "Nrepeat", "Nfreq")))
        names, rest = sampled.split(words[3:])
        k = next((k for k, w in enumerate(rest) if w not in MOMENTS), len(rest))
        options = sampled.keywords(rest[k:], KEYWORDS, what)
        for word in names:
            if word.count("[") > 1:
                raise InputError(f"{what}: {word} is an element of an array, it takes scalars and elements of vectors")
        values = [read(w, session, what).check("scalar", what) for w in expand(names, session)]
        numbers = {name: whole(value[0], f"{what} {name}") for name, value in options.items()}
        fix = cls(group, values, rest[:k], every, repeat, freq, **numbers)
        fix.session, fix.words = session, list(words)
        sampled.check_frequencies(fix)
        fix.begin(session.scene.step)
        return fix

    def to_lammps(self) -> list[str]:
        own = [*(str(n) for n in (self.sample_every, self.repeat, self.freq)), *(v.word for v in self.values), *self.moments]
        return getattr(self, "words", own)

    def first_sample(self, step: int) -> int:
        """The first step with a sample; one that has begun before `step` goes on behind it."""
        due = super().first_sample(step)
        whole_window = (self.repeat - 1) * self.sample_every
        earlier = due - self.freq
        if earlier < step < earlier + whole_window and earlier + whole_window >= self.start:
            return (step // self.sample_every + 1) * self.sample_every
        return due

    def end_of_step(self, loop) -> None:
        """Take a sample; on multiples of Nfreq, the result."""
        step = loop.step
        self.sample(self.look(loop))
        if step % self.freq == 0 and step >= self.start:
            self.conclude(step)
        window = (step // self.freq + 1) * self.freq - (self.repeat - 1) * self.sample_every
        self.next_sample = max(step + self.sample_every, window)

    def sample(self, snapshot) -> None:
        self._samples.append([v.scalar(snapshot) for v in self.values])

    def conclude(self, step: int) -> None:
        if len(self._samples) > 2:
            self.results.insert(0, np.array([moment(name, column) for column in np.array(self._samples).T for name in self.moments]))
            del self.results[self.history:]

    # ---- outputs
    @property
    def size(self) -> int:
        return len(self.values) * len(self.moments)

    outputs = ("vector", "array")

    def array_columns(self) -> int:
        return self.history

    def extensive_at(self, index) -> bool:
        return self.values[0].extensive()

    def vector(self, i: int) -> float:
        """Moment `i` of the newest result."""
        return self._at(i, 1)

    def array(self, i: int, j: int) -> float:
        """Moment `i`, `j` - 1 results ago."""
        return self._at(i, j)

    def _at(self, i: int, j: int) -> float:
        if not (1 <= i <= self.size and 1 <= j <= self.history):
            raise InputError(f"fix {self.id} (style {self.style}) has {self.size} moments and {self.history} results, "
                             f"there is no [{i}][{j}]")
        return float(self.results[j - 1][i - 1]) if j <= len(self.results) else 0.0
