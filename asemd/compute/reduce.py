r"""One number of many: the sum, mean, smallest or largest value of per-atom or local values.

Modes: sum min max ave, sumsq avesq (of squares), sumabs aveabs minabs maxabs (of magnitudes). Each input gives one number; with one input
it is a scalar, else a vector. Per-atom values count for atoms of the group; local values count all. ``replace k m``, for min and max, gives
in place of number k the k-th value of the atom (or bond ...) that has the extreme m-th value.

Source: LAMMPS manual, compute reduce. Units: those of the input.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._inputs import Input, expand
from asemd.errors import InputError, nearest
from asemd.words import choice, take, whole

EMPTY = 1.0e20      # the smallest of no values, minus the largest
MODES = {
    "sum": np.sum, "sumsq": lambda v: np.sum(v * v), "sumabs": lambda v: np.sum(np.abs(v)),
    "ave": np.sum, "avesq": lambda v: np.sum(v * v), "aveabs": lambda v: np.sum(np.abs(v)),
    "min": lambda v: v.min(initial=EMPTY), "max": lambda v: v.max(initial=-EMPTY),
    "minabs": lambda v: np.abs(v).min(initial=EMPTY), "maxabs": lambda v: np.abs(v).max(initial=0.0),
}
KEYWORDS = ("replace", "inputs")
INPUTS = {"peratom": "per_atom", "local": "local"}


class Reduce(Compute):
    """Reduction of values.

    Parameters
    ----------
    group : str
        The atoms whose per-atom values count.
    mode : str
        A key of `MODES`.
    inputs : sequence of asemd.compute._inputs.Input
    replace : dict[int, int], optional
        Input -> the input whose extreme value chooses, from 1.
    kind : str
        ``per_atom`` or ``local`` for inputs that have both; empty: the first they have.

    Raises
    ------
    InputError
        Unknown mode, inputs of different kinds, ``replace`` that makes no sense.
    """

    style = "reduce"

    def __init__(self, group: str = "all", mode: str = "sum", inputs=(), replace: dict[int, int] | None = None, kind: str = ""):
        super().__init__(group)
        self.what = f"compute {self.style}"
        self.mode, self.inputs, self.replace, self.kind = choice(mode, MODES, f"{self.what} mode"), list(inputs), dict(replace or {}), kind
        if not self.inputs:
            raise InputError(f"{self.what} needs at least one value, for example: c_ID")
        kinds = [i.must_give(kind or "per_atom", kind or "local") for i in self.inputs]
        if len(set(kinds)) > 1:
            raise InputError(f"{self.what}: values must be all per-atom or all local, {self.inputs[0]} and "
                             f"{next(i for i, k in zip(self.inputs, kinds) if k != kinds[0])} are not")
        self.of = kinds[0]
        for old, new in self.replace.items():
            if mode not in ("min", "max", "minabs", "maxabs"):
                raise InputError(f"{self.what}: replace needs mode min or max, not {mode}")
            if not (1 <= old <= len(self.inputs) and 1 <= new <= len(self.inputs)) or old == new or new in self.replace:
                raise InputError(f"{self.what}: replace {old} {new} must name two values, the second of which is not replaced itself")

    @property
    def extensive(self) -> bool:
        return self.mode in ("sum", "sumsq", "sumabs")

    @property
    def needs(self) -> frozenset[str]:
        return frozenset().union(*(i.needs for i in self.inputs))

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls._read(group, words, session)

    @classmethod
    def _read(cls, group, words, session, **more):
        what = f"compute {cls.style}"
        mode = choice(take(words, 1, what)[0], MODES, f"{what} mode")
        words, options = words[1:], []
        at = next((k for k, w in enumerate(words) if w in KEYWORDS), len(words))
        words, options = words[:at], words[at:]
        replace, kind = {}, ""
        while options:
            key = options[0]
            if key not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
            values = take(options[1:], 2 if key == "replace" else 1, f"{what} {key}")
            if key == "replace":
                replace[whole(values[0], f"{what} replace")] = whole(values[1], f"{what} replace")
            else:
                kind = INPUTS[choice(values[0], INPUTS, f"{what} inputs")]
            options = options[1 + len(values):]
        words = expand(words, session, *([kind] if kind else ["per_atom", "local"]))
        return cls(group, mode, [Input(w, what, session) for w in words], replace, kind, **more)

    def to_lammps(self) -> list[str]:
        out = [self.mode, *map(str, self.inputs)]
        for old, new in self.replace.items():
            out += ["replace", str(old), str(new)]
        return out + (["inputs", {v: k for k, v in INPUTS.items()}[self.kind]] if self.kind else [])

    @property
    def size(self) -> int:
        """Elements of the vector."""
        return len(self.inputs)

    def chosen(self, state) -> np.ndarray:
        """(n,) the atoms that count."""
        return state.mask(self.group)

    def _values(self, state) -> list[np.ndarray]:
        if self.of == "local":
            return [np.asarray(i.local(state)) for i in self.inputs]
        mask = self.chosen(state)
        values = [i.per_atom(state) for i in self.inputs]
        return values if mask.all() else [v[mask] for v in values]

    def _all(self, state) -> np.ndarray:
        columns = self._values(state)
        out = np.array([float(MODES[self.mode](c)) for c in columns])
        if self.mode.startswith("ave"):
            out = np.array([s / len(c) if len(c) else 0.0 for s, c in zip(out, columns)])
        pick = np.argmin if self.mode.startswith("min") else np.argmax
        for old, new in self.replace.items():
            by = columns[new - 1]
            if len(by):
                out[old - 1] = columns[old - 1][pick(np.abs(by) if self.mode.endswith("abs") else by)]
        return out

    def scalar(self, state) -> float:
        """The number of the only input."""
        if len(self.inputs) > 1:
            raise InputError(f"compute {self.id} ({self.style}) has {len(self.inputs)} values: write c_{self.id}[1]")
        return float(self._all(state)[0])

    def vector(self, state) -> np.ndarray:
        """A number for each of several inputs."""
        if len(self.inputs) == 1:
            raise InputError(f"compute {self.id} ({self.style}) has one value: write c_{self.id}")
        return self._all(state)
