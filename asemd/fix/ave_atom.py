r"""Average values of each atom over time.

.. math:: \bar a_i(t) = \frac{1}{N} \sum_{k=0}^{N-1} a_i(t - k\,m)

with :math:`N` = Nrepeat samples, :math:`m` = Nevery steps apart, known on multiples of Nfreq. Positions are those inside the box.

Source: LAMMPS manual, fix ave/atom. Output: values per atom, a column for each value; zero outside the group.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.sampled import Sampled
from asemd.fix.values import ATOM_WORDS, expand, read
from asemd.words import take, whole


class AveAtom(Sampled):
    """Average values of each atom over time.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    values : sequence of str, Compute, (Compute, column) or callable
        Words such as ``vx``; computes with per-atom values; functions of a Snapshot that return (n,).
    sample_every, repeat, freq : int
        Steps between samples, samples of an average, steps between averages.

    Raises
    ------
    InputError
        Intervals that do not fit together, no value.
    """

    style = "ave/atom"

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, repeat: int = 1, freq: int = 1):
        super().__init__(group, values, sample_every, repeat, freq)
        if not self.values:
            raise InputError("fix ave/atom needs at least one value")
        self._mean: np.ndarray | None = None
        self._sum: np.ndarray | None = None

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix ave/atom"
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 4, what), ("Nevery", "Nrepeat", "Nfreq")))
        values = [read(w, session, what, ATOM_WORDS).check("per_atom", what) for w in expand(words[3:], session, vectors=True)]
        fix = cls(group, values, every, repeat, freq)
        fix.session, fix.words = session, list(words)
        sampled.check_frequencies(fix)
        fix.begin(session.scene.step)
        return fix

    def to_lammps(self) -> list[str]:
        return self.words if hasattr(self, "words") else [str(n) for n in (self.sample_every, self.repeat, self.freq)] + [
            v.word for v in self.values]

    def atom_arrays(self, loop):
        """The averages go with the atoms."""
        n = loop.system.n
        self._mean, self._sum = (np.zeros((n, len(self.values))) if a is None or len(a) != n else a for a in (self._mean, self._sum))
        return self._mean, self._sum

    def sample(self, snapshot) -> None:
        system = snapshot.system
        if self._mean is None:
            self._mean, self._sum = (np.zeros((system.n, len(self.values))) for _ in range(2))
        if self.count == 0:
            self._sum[:] = 0.0
        mask = snapshot.mask(self.group)
        for k, value in enumerate(self.values):
            np.add(self._sum[:, k], value.per_atom(snapshot), out=self._sum[:, k], where=mask)

    def conclude(self, step: int) -> None:
        self._mean[:] = self._sum / self.repeat

    def per_atom_columns(self) -> int:
        return len(self.values) if len(self.values) > 1 else 0

    def per_atom(self, state=None) -> np.ndarray:
        """(n,) for one value, else (n, values): the last complete averages."""
        n = state.system.n if state is not None else 0
        values = self._mean if self._mean is not None and (state is None or len(self._mean) == n) else np.zeros((n, len(self.values)))
        return values if len(self.values) > 1 else values[:, 0]
