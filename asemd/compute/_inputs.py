"""Values that computes take from elsewhere: ``x``, ``c_ID``, ``c_ID[2]``, ``f_ID``, ``f_ID[2]``, ``v_name``."""
from __future__ import annotations

import re

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError, nearest

ATTRIBUTES = {f"{array}{axis}": (array or "x", k) for array in ("", "v", "f") for k, axis in enumerate("xyz")}
WORD = re.compile(r"([cfv])_(\w+)(?:\[(\d+)\])?")
RANGE = re.compile(r"([cf])_(\w+)\[(\d*)\*(\d*)\]")
KINDS = ("scalar", "vector", "array", "per_atom", "local")


def expand(words: list[str], session, *kinds: str) -> list[str]:
    """``c_ID[2*4]`` as ``c_ID[2] c_ID[3] c_ID[4]``; `kinds` are those of values that are meant, the first one that is there counts."""
    out = []
    for word in words:
        if not (found := RANGE.fullmatch(word)):
            out.append(word)
            continue
        kind, id, first, last = found.groups()
        one = Input(f"{kind}_{id}", "wildcard", session)
        last = int(last) if last else one.width(kinds, session)
        out += [f"{kind}_{id}[{k}]" for k in range(int(first or 1), last + 1)]
    return out


class Input:
    """One word.

    Parameters
    ----------
    word : str
    what : str
        The command that has it, for messages.
    session
        Its scene and variables are asked for the values.

    Raises
    ------
    InputError
        No such compute, fix or variable; not a reference at all.
    """

    def __init__(self, word: str, what: str, session):
        self.word, self.what, self.session = word, what, session
        if word in ATTRIBUTES:
            self.kind, self.id, self.column = "x", word, None
            return
        found = WORD.fullmatch(word)
        if not found:
            raise InputError(f"{what}: {word!r} is not a value such as c_ID, c_ID[2], f_ID or v_name")
        self.kind, self.id, self.column = found[1], found[2], int(found[3]) if found[3] else None
        if self.kind == "v":
            session.variables.find(self.id)
            if self.column is not None:
                raise InputError(f"{what}: {word}: variables have no columns")
        elif self.id not in self._table:
            name = "compute" if self.kind == "c" else "fix"
            raise InputError(f"{what}: there is no {name} {self.id}{nearest(self.id, self._table)}")

    def __str__(self) -> str:
        return self.word

    @property
    def _table(self) -> dict:
        return self.session.scene.computes if self.kind == "c" else self.session.scene.fixes

    @property
    def source(self):
        """The compute or fix.

        Raises
        ------
        InputError
            It is not there any more.
        """
        if self.id not in self._table:
            raise InputError(f"{self.what}: {self.word} is not there any more")
        return self._table[self.id]

    def gives(self, kind: str) -> bool:
        """Whether there are such values: of `KINDS`."""
        if self.kind == "x":
            return kind == "per_atom"
        if self.kind == "v":
            style = self.session.variables.find(self.id).style
            return style in {"per_atom": ("atom", "atomfile"), "vector": ("vector",), "scalar": ("equal", "internal")}.get(kind, ())
        if self.kind == "c":
            return getattr(type(self.source), kind) is not getattr(Compute, kind)
        return self.session.variables.provider.has("f", self.id, kind)

    def must_give(self, *kinds: str) -> str:
        """The first of these kinds that there is.

        Raises
        ------
        InputError
            None of them.
        """
        for kind in kinds:
            if self.gives(kind):
                return kind
        names = " or ".join({"per_atom": "per-atom"}.get(k, k) for k in kinds)
        raise InputError(f"{self.what}: {self.word} gives no {names} values")

    def width(self, kinds: tuple[str, ...], session) -> int:
        kind = self.must_give(*kinds)
        code = "c" if self.kind == "c" else "f"
        if kind == "per_atom":
            return session.variables.provider.per_atom_columns(code, self.id)
        if kind == "local":
            return session.variables.provider.local_columns(code, self.id)
        if kind == "vector":
            return session.variables.provider.vector_length(code, self.id)
        columns = getattr(self.source, "columns", None)
        return columns if isinstance(columns, int) else np.asarray(session.moment.array(self.id)).shape[1]

    @property
    def needs(self) -> frozenset[str]:
        """What forces must bring on steps where it is used."""
        computes = self.session.scene.computes
        if self.kind == "v":
            names = self.session.variables.references("v_" + self.id)
            return frozenset().union(*(computes[n[2:]].needs for n in names if n.startswith("c_") and n[2:] in computes))
        return computes[self.id].needs if self.kind == "c" and self.id in computes else frozenset()

    def per_atom(self, state) -> np.ndarray:
        """(n,) by atom row."""
        if self.kind == "x":
            array, k = ATTRIBUTES[self.id]
            return getattr(state.system, array)[:, k]
        if self.kind == "v":
            return np.asarray(self.session.variables.per_atom(self.id, state.system.n), float)
        return self._column(self._values("per_atom", state))

    def local(self, state) -> np.ndarray:
        """(m,) local values."""
        return self._column(self._values("local", state))

    def vector(self, state) -> np.ndarray:
        """A global vector, or a column of a global array."""
        if self.kind == "v":
            return np.asarray(self.session.variables.vector(self.id), float)
        if self.kind == "f":
            return self.session.variables.provider.vector("f", self.id, self.column)
        if self.column is None:
            return np.asarray(self._values("vector", state), float)
        return self._column(self._values("array", state))

    def _values(self, kind: str, state) -> np.ndarray:
        moment = getattr(self.session, "moment", None)
        if self.kind == "c" and moment is not None and getattr(moment, "_snapshot", None) is state:
            return np.asarray(getattr(moment, kind)(self.id), float)     # evaluated once for all who ask
        return np.asarray(getattr(self.source, kind)(state), float)

    def _column(self, values: np.ndarray) -> np.ndarray:
        if self.column is None and values.ndim == 1:
            return values
        if self.column is not None and values.ndim == 2 and 1 <= self.column <= values.shape[1]:
            return values[:, self.column - 1]
        raise InputError(f"{self.what}: {self.word}: the values have {values.shape[1] if values.ndim == 2 else 'no'} columns")
