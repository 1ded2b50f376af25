r"""Store global values as a vector (one value) or array (a column for each value) that grows with time, one row every N steps.

With ``nmax M`` only the last M rows are kept.

Source: LAMMPS manual, fix vector. Output: a vector or an array.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.sampled import Sampled
from asemd.fix.values import expand, read
from asemd.words import take, whole

KEYWORDS = {"nmax": 1}


class Vector(Sampled):
    """Store global values of many steps.

    Parameters
    ----------
    group : str
        Has no effect.
    values : sequence of Compute, (Compute, index) or callable
        Numbers; functions take a `asemd.engine.Snapshot`.
    sample_every : int
        Steps between two rows; they are multiples of it.
    longest : int, optional
        Rows that are kept; None: all.

    Raises
    ------
    InputError
        No value, an interval below 1.
    """

    style = "vector"

    def __init__(self, group: str = "all", values=(), sample_every: int = 1, longest: int | None = None):
        super().__init__(group, values, sample_every, 1, sample_every)
        if not self.values:
            raise InputError("fix vector needs at least one value")
        if longest is not None and longest < 1:
            raise InputError(f"fix vector: nmax must be at least 1, got {longest}")
        self.longest, self.data = longest, []

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix vector"
        every = whole(take(words, 2, what)[0], f"{what} Nevery")
        names, rest = sampled.split(words[1:])
        if not names:
            raise InputError(f"{what} needs at least one value after Nevery")
        options = sampled.keywords(rest, KEYWORDS, what)
        values = [read(w, session, what).check("scalar", what) for w in expand(names, session)]
        if len({v.extensive() for v in values}) > 1:
            raise InputError(f"{what}: values that grow with the system and values that do not cannot be in one array")
        fix = cls(group, values, every, whole(options["nmax"][0], f"{what} nmax") if "nmax" in options else None)
        fix.session, fix.words = session, list(words)
        sampled.check_frequencies(fix)
        fix.begin(session.scene.step)
        return fix

    def to_lammps(self) -> list[str]:
        return self.words if hasattr(self, "words") else [str(self.sample_every), *(v.word for v in self.values)]

    def first_sample(self, step: int) -> int:
        return -(-step // self.sample_every) * self.sample_every

    def sample(self, snapshot) -> None:
        self.data.append([v.scalar(snapshot) for v in self.values])
        if self.longest is not None and len(self.data) > self.longest:
            del self.data[0]

    def conclude(self, step: int) -> None:
        """Each row stands for itself."""

    @property
    def outputs(self) -> tuple[str, ...]:
        return ("vector",) if len(self.values) == 1 else ("array",)

    @property
    def size(self) -> int:
        return len(self.data)

    def array_columns(self) -> int:
        return len(self.values)

    def extensive_at(self, index) -> bool:
        return self.values[0].extensive()

    def whole_vector(self, column: int | None = None) -> np.ndarray:
        """All rows of the vector, or of a column (from 1) of the array."""
        if column is not None and not 1 <= column <= len(self.values):
            raise InputError(f"fix {self.id} (style vector) has {len(self.values)} columns, there is no column {column}")
        return np.array(self.data, float).reshape(-1, len(self.values))[:, (column or 1) - 1]

    def vector(self, i: int) -> float:
        if "vector" not in self.outputs:
            return super().vector(i)
        return self._at(i, 1)

    def array(self, i: int, j: int) -> float:
        if "array" not in self.outputs:
            raise InputError(f"fix {self.id} (style vector) has no global array")
        return self._at(i, j)

    def _at(self, i: int, j: int) -> float:
        if not (1 <= i <= len(self.data) and 1 <= j <= len(self.values)):
            raise InputError(f"fix {self.id} (style vector): there is no element [{i}][{j}], it has {len(self.data)} rows of "
                             f"{len(self.values)}")
        return float(self.data[i - 1][j - 1])
