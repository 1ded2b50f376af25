"""Values that fixes average, store or print: words of a script such as ``c_ID[2]``, ``f_ID``, ``v_name``, ``vx``; in Python computes and
functions of a `asemd.engine.Snapshot`.
"""
from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError, nearest
from asemd.thermo import EXTENSIVE, KEYWORDS

WORD = re.compile(r"([cfv])_(\w+)((?:\[[^\[\]]*\])*)")
INDEX = re.compile(r"\[([^\[\]]*)\]")
AXES = "xyz"
ATOM_WORDS = ("x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz")
NAMES = {"c": "compute", "f": "fix", "v": "variable"}
KINDS = ("scalar", "vector", "array", "per_atom", "local")


@dataclass(frozen=True)
class Value:
    """One input.

    Attributes
    ----------
    word : str
        As titles of files show it.
    kind : str
        ``c``, ``f``, ``v``; ``atom`` for x, vx, fx ...; ``python`` for a compute or function given in Python.
    id : str
    index : tuple of int
        From 1.
    source : callable or Compute, optional
        For ``python``.
    session : optional
        Knows computes, fixes and variables.
    """

    word: str
    kind: str
    id: str = ""
    index: tuple[int, ...] = ()
    source: Any = None
    session: Any = None

    # ---- what it is
    def gives(self, what: str) -> bool:
        """Whether it has ``scalar`` (one number), ``vector``, ``per_atom`` or ``local`` values."""
        if self.kind == "python":
            return True
        if self.kind == "atom":
            return what == "per_atom"
        if self.kind == "v":
            style = self.session.variables.find(self.id).style
            if self.index:
                return what == "scalar" and style in ("vector", "atom", "atomfile")
            return style in {"scalar": ("equal", "internal", "python", "timer", "index", "loop", "string", "format", "getenv", "file"),
                             "vector": ("vector",), "per_atom": ("atom", "atomfile")}.get(what, ())
        has = self.session.variables.provider.has
        if what == "scalar":
            return has(self.kind, self.id, ("scalar", "vector", "array")[len(self.index)]) if len(self.index) < 3 else False
        if what == "vector":
            return len(self.index) < 2 and has(self.kind, self.id, ("vector", "array")[len(self.index)])
        if len(self.index) > 1 or not has(self.kind, self.id, what):
            return False
        return bool(columns_of(self.session, self.kind, self.id, what)) == bool(self.index)

    def check(self, what: str, command: str) -> Value:
        """Itself, or `InputError` if it has no such values."""
        if self.kind in "cf" and self.session is not None:
            self.session.variables.provider.source(self.kind, self.id)
        if not self.gives(what):
            shown = {"scalar": "one number", "vector": "a vector", "per_atom": "a value for each atom", "local": "local values"}[what]
            raise InputError(f"{command}: {self.word} does not give {shown}")
        if self.kind == "c" and what == "scalar" and len(self.index) == 1:
            size = getattr(self.session.scene.computes[self.id], "size", None)
            if size and self.index[0] > size:
                raise InputError(f"{command}: {self.word}: the vector has {size} elements, there is no element {self.index[0]}")
        return self

    def extensive(self, what: str = "scalar") -> bool:
        """Whether it grows with the system, as thermo output sees it."""
        if self.kind not in ("c", "f"):
            return False
        source = self.session.variables.provider.source(self.kind, self.id)
        if hasattr(source, "extensive_at"):
            return source.extensive_at(self.index)
        if self.kind == "c" and (self.index or what == "vector") and source.style.startswith("temp"):
            return True
        return bool(getattr(source, "extensive", getattr(source, "ecouple", False) or source.style in EXTENSIVE))

    def needs(self) -> set[str]:
        """What must be computed of a step on which it is asked for."""
        if self.kind == "python":
            return set(getattr(self.source, "needs", ()))
        return needs_of([self.word], self.session) if self.kind in "cfv" else set()

    # ---- what it has now
    def scalar(self, snapshot) -> float:
        """One number."""
        if self.kind == "python":
            return float(self._own(snapshot, ("scalar", "vector", "array")[len(self.index)]))
        if self.kind == "v":
            return float(self.session.variables.number(self.id, *self.index))
        return float(self.session.variables.provider.reference(self.kind, self.id, list(self.index)))

    def vector(self, snapshot) -> np.ndarray:
        """(m,) a global vector or the column of a global array."""
        if self.kind == "python":
            return np.atleast_1d(np.asarray(self._own(snapshot, "array" if self.index else "vector"), float))
        if self.kind == "v":
            return np.asarray(self.session.variables.vector(self.id), float)
        return np.asarray(self.session.variables.provider.vector(self.kind, self.id, self.index[0] if self.index else None), float)

    def per_atom(self, snapshot) -> np.ndarray:
        """(n,) by atom row."""
        if self.kind == "python":
            return np.asarray(self._own(snapshot, "per_atom"), float)
        if self.kind == "atom":
            return atom_word(snapshot.system, self.id)
        if self.kind == "v":
            return np.asarray(self.session.variables.per_atom(self.id, snapshot.system.n), float)
        return np.asarray(self.session.variables.provider.per_atom(self.kind, self.id, self.index[0] if self.index else None), float)

    def local(self, snapshot) -> np.ndarray:
        """(m,) local values."""
        if self.kind == "python":
            return np.asarray(self._own(snapshot, "local"), float)
        return np.asarray(self.session.variables.provider.local(self.kind, self.id, self.index[0] if self.index else None), float)

    def _own(self, snapshot, what: str):
        """Of a compute or function of one's own."""
        if not isinstance(self.source, Compute):
            return self.source(snapshot)
        values = getattr(self.source, what)(snapshot)
        if not self.index:
            return values
        at = tuple(i - 1 for i in self.index)
        return values[..., at[0]] if what in ("per_atom", "local") or (what == "array" and len(at) == 1) else values[at]


def atom_word(system, word: str) -> np.ndarray:
    """(n,) ``x`` to ``fz`` of all atoms; x, y and z inside the box."""
    array = {"v": system.v, "f": system.f}[word[0]] if len(word) == 2 else system.x
    return array[:, AXES.index(word[-1])].copy()


def given(value, number: int) -> Value:
    """The input of a compute, of ``(compute, i)`` or of a function of a Snapshot that a Python user gave."""
    if isinstance(value, Value):
        return value
    index: tuple[int, ...] = ()
    if isinstance(value, tuple):
        value, *rest = value
        index = tuple(int(i) for i in rest)
    if isinstance(value, str):
        if value in ATOM_WORDS:
            return Value(value, "atom", value)
        raise InputError(f"{value!r} is no value: give a compute, a function of a snapshot, or one of {' '.join(ATOM_WORDS)}")
    if not callable(value) and not isinstance(value, Compute):
        raise InputError(f"{value!r} is no value: give a compute or a function of a snapshot")
    name = value.style if isinstance(value, Compute) else getattr(value, "__name__", "")
    shown = name if re.fullmatch(r"[\w/]+", name) else f"value{number}"
    return Value(shown + "".join(f"[{i}]" for i in index), "python", index=index, source=value)


def read(word: str, session, command: str, words: Sequence[str] = ()) -> Value:
    """A word of a script; `words` are the names besides c_, f_ and v_ that may stand there."""
    if word in words:
        return Value(word, "atom", word, session=session)
    match = WORD.fullmatch(word)
    if not match:
        known = nearest(word, words) if words else ""
        raise InputError(f"{command}: {word!r} is no value, it must be c_ID, f_ID or v_name{' or one of ' * bool(words)}"
                         f"{' '.join(words)}{known}")
    index = []
    for text in INDEX.findall(match[3]):
        if text.startswith("v_"):
            text = f"{session.variables.number(text[2:]):g}"
        if not re.fullmatch(r"[1-9]\d*", text):
            raise InputError(f"{command}: {word}: an index must be a whole number from 1 on, got {text!r}")
        index.append(int(text))
    if len(index) > 2:
        raise InputError(f"{command}: {word} has too many indices")
    kind, id = match[1], match[2]
    if kind == "v":
        session.variables.find(id)
    else:
        session.variables.provider.source(kind, id)
    return Value(word, kind, id, tuple(index), session=session)


def columns_of(session, kind: str, id: str, what: str) -> int:
    """Columns of per-atom or local values, 0 for a vector."""
    source = session.variables.provider.source(kind, id)
    if what == "local":
        return source.local_columns() or 0
    width = getattr(source, "per_atom_columns", None)
    if width is not None:
        return width()
    columns = getattr(source, "columns", None)
    if isinstance(columns, int):
        return columns
    if session.moment._snapshot is not None:
        values = np.asarray(session.moment.per_atom(id) if kind == "c" else source.per_atom(session.moment.snapshot))
        return values.shape[1] if values.ndim == 2 else 0
    return 0


def expand(words: Sequence[str], session, vectors: bool = False) -> list[str]:
    """``c_ID[*]``, ``c_ID[2*4]`` ... written out: elements of a global vector (columns of an array, if `vectors`), or columns per atom."""
    out: list[str] = []
    for word in words:
        match = re.fullmatch(r"([cfv])_(\w+)\[(\d*)\*(\d*)\](.*)", word)
        if not match:
            out.append(word)
            continue
        kind, id, first, last, rest = match.groups()
        longest = _width(session, kind, id, vectors)
        if longest is None:
            out.append(word)
            continue
        lo, hi = int(first or 1), int(last or longest)
        if not 1 <= lo <= hi <= longest:
            raise InputError(f"{word}: {kind}_{id} has the elements 1 to {longest}")
        out += [f"{kind}_{id}[{k}]{rest}" for k in range(lo, hi + 1)]
    return out


def _width(session, kind: str, id: str, vectors: bool) -> int | None:
    """How many elements ``[*]`` stands for."""
    provider = session.variables.provider
    if kind == "v":
        return len(session.variables.vector(id)) if session.variables.find(id).style == "vector" else None
    source = provider.source(kind, id)
    if not vectors and provider.has(kind, id, "vector"):
        return provider.vector_length(kind, id)
    if vectors and provider.has(kind, id, "array"):
        columns = getattr(source, "array_columns", None)
        if kind == "c":
            columns = source.array_columns()
        if columns is None:
            raise InputError(f"{kind}_{id}[*]: the number of columns is not known, write them out")
        return columns() if callable(columns) else columns
    if provider.has(kind, id, "per_atom") and (width := columns_of(session, kind, id, "per_atom")):
        return width
    return (source.local_columns() if hasattr(source, "local_columns") else 0) or None


def needs_of(words: Sequence[str], session) -> set[str]:
    """What the forces of a step must bring so that these references, also within variables, can be evaluated."""
    references, scene = session.variables.references, session.scene
    found = set(scene.thermo.needs(words, scene.computes, references))
    names = {n for w in words if w.startswith("v_") for n in references(w)}
    if any(n in KEYWORDS and (KEYWORDS[n].extensive or KEYWORDS[n].needs) for n in names):
        found.add("energy")
    for name in names | {w.partition("[")[0] for w in words}:
        if name.startswith("f_") and name[2:] in scene.fixes:
            found |= scene.fixes[name[2:]].output_needs
    return found


def snapshot_of(loop, session, needs=()):
    """The present step as computes and variables see it; `session` sees it too."""
    loop.sync_out()
    loop.system.step = loop.step
    loop.engine.per_atom(loop.result, needs)
    if session is not None:
        session.look(loop)
        return session.moment.snapshot
    return loop.snapshot()


Source = Value | Compute | tuple | Callable[[Any], Any]
__all__ = ["ATOM_WORDS", "KINDS", "Source", "Value", "columns_of", "expand", "given", "needs_of", "read", "replace", "snapshot_of"]
