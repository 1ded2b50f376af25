"""Variables: their texts, and the numbers that their formulas give.

Source: the LAMMPS manual page of ``variable``. There is one partition, so ``world``, ``universe`` and ``uloop`` are ``index`` and ``loop``
of that one.
"""
from __future__ import annotations

import math
import os
import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asemd.errors import InputError, nearest
from asemd.formula import Parser, Provider
from asemd.formula_functions import Clock, Value
from asemd.marsaglia import Marsaglia
from asemd.words import LARGEST

STYLES = ("delete", "index", "loop", "world", "universe", "uloop", "string", "getenv", "file", "atomfile", "format", "internal", "python",
          "timer", "equal", "vector", "atom")
KEPT = ("index", "loop", "world", "universe", "uloop", "file", "atomfile")      # a second definition is ignored
UNIVERSE = ("universe", "uloop")
STEPPED = ("index", "loop", *UNIVERSE, "file", "atomfile")                      # `next` moves them on
FORMULAS = ("equal", "atom", "vector")
FORMAT = r"%[-0 ]*\d{0,3}(\.\d{1,3})?[eEfFgG]"


@dataclass
class Variable:
    """One variable: its style, its texts and which of them is current.

    `sets` are the values of style ``atomfile`` by atom id, one set for each text; `values` those of a vector that is a list of numbers.
    """

    style: str
    words: Sequence[str]
    current: int = 0
    sets: list[dict[int, float]] = field(default_factory=list)
    values: np.ndarray | None = None

    @property
    def text(self) -> str:
        return self.words[self.current]


@dataclass
class Variables:
    """All variables of a session, and their evaluation."""

    provider: Provider | None = None
    table: dict[str, Variable] = field(default_factory=dict)
    _active: list[str] = field(default_factory=list)
    _random: dict[str, Marsaglia] = field(default_factory=dict)
    _start: float = field(default_factory=time.perf_counter)

    def define(self, name: str, style: str, words: list[str]) -> None:
        """``variable name style words...``; a string that is already there stays, a formula is replaced."""
        if not re.fullmatch(r"\w+", name):
            raise InputError(f"variable name {name!r} must have only letters, numbers and underscores")
        if style not in STYLES:
            known = nearest(style, STYLES) or f"; there are {' '.join(STYLES)}"
            raise InputError(f"variable {name}: style {style!r} is unknown or not supported{known}")
        if style == "delete":
            self.table.pop(name, None)
            return
        old = self.table.get(name)
        if old is not None:
            if style in KEPT:
                return
            if old.style != style:
                raise InputError(f"variable {name} exists with style {old.style}; delete it before it becomes style {style}")
        if style == "atomfile":
            sets = _read_sets(_one(name, style, words))
            new = Variable(style, [str(k) for k in range(len(sets))], sets=sets)
        else:
            new = Variable(style, self._words(name, style, words))
            if style == "vector" and new.text.startswith("["):
                new.values = _listed(name, new.text)
        self.table[name] = new

    def _words(self, name: str, style: str, words: list[str]) -> Sequence[str]:
        if style in ("loop", "uloop"):
            return _loop(name, style, words)
        if style == "timer":
            if words:
                raise InputError(f"variable {name} timer takes no values, got {' '.join(words)}")
            return [repr(time.perf_counter())]
        if style == "file":
            return _read_lines(_one(name, style, words))
        need = {"format": 2, "string": 1, "getenv": 1, "internal": 1, "python": 1}
        if not words or len(words) != need.get(style, len(words)):
            raise InputError(f"variable {name} {style} needs {need.get(style, 'at least 1')} value(s), got {len(words)}")
        if style in FORMULAS:
            return [" ".join(words)]
        if style == "world" and len(words) != 1:
            raise InputError(f"variable {name} world has {len(words)} values, but there is one partition")
        if style == "universe":
            self._same_number(name, len(words))
        if style == "internal":
            _number(words[0], f"variable {name} internal")
        if style == "format":
            if words[0] not in self.table:
                raise InputError(f"variable {name} format: undefined variable {words[0]}{nearest(words[0], self.table)}")
            if self.table[words[0]].style not in ("equal", "internal", "python", "timer"):
                raise InputError(f"variable {name} format: variable {words[0]} of style {self.table[words[0]].style} is no number")
            if not re.fullmatch(FORMAT, words[1]):
                raise InputError(f"variable {name}: format {words[1]} must be one of %e, %f, %g")
        return list(words)

    def _same_number(self, name: str, count: int) -> None:
        """All variables of styles universe and uloop have as many values."""
        for other, variable in self.table.items():
            if variable.style in UNIVERSE and len(variable.words) != count:
                raise InputError(f"variable {name} has {count} values where {other} has {len(variable.words)}: all universe and uloop "
                                 "variables must have the same number")

    def set(self, name: str, text: str) -> None:
        """Set a string or internal variable to another text."""
        self.find(name).words = [text]

    def advance(self, names: list[str]) -> bool:
        """``next``: step the variables on; those that are exhausted go. Returns whether they were exhausted."""
        kinds = {self.find(n).style for n in names}
        unstepped = kinds - set(STEPPED)
        if unstepped:
            raise InputError(f"next: a variable of style {unstepped.pop()} has no next value")
        if len(kinds) > 1 and not kinds <= set(UNIVERSE):
            raise InputError("next: all variables must have the same style")
        done = False
        for name in names:
            variable = self.table[name]
            variable.current += 1
            if variable.current >= len(variable.words):
                done = True
        if done:
            for name in set(names):
                del self.table[name]
        return done

    def find(self, name: str) -> Variable:
        """The variable of that name, or `InputError`."""
        if name not in self.table:
            raise InputError(f"undefined variable {name}{nearest(name, self.table)}")
        return self.table[name]

    def value(self, name: str) -> str:
        """The text that replaces ``${name}``."""
        variable = self.find(name)
        if variable.style in ("equal", "timer"):
            return f"{self.number(name):.15g}"
        if variable.style == "internal":
            return f"{float(variable.text):.15g}"
        if variable.style == "getenv":
            return os.environ.get(variable.text, "")
        if variable.style == "format":
            return variable.words[1] % self.number(variable.words[0])
        if variable.style == "python":
            return self._called(name, None)
        if variable.style == "vector":
            return "[" + ",".join(repr(float(v)).removesuffix(".0") for v in self.vector(name)) + "]"
        if variable.style in ("atom", "atomfile"):
            raise InputError(f"variable {name} has style {variable.style} and no text to put here")
        return variable.text

    def number(self, name: str, *index: int) -> float:
        """The value of a variable as one number; with an index (from 1) that of ``v_name[index]``."""
        variable = self.find(name)
        if index:
            return self.element(name, *index)
        if variable.style == "equal":
            return self._guarded(name, lambda: self.evaluate(variable.text))
        if variable.style == "timer":
            return float(variable.text) - self._start
        if variable.style in ("atom", "atomfile", "vector"):
            raise InputError(f"variable {name} has style {variable.style} where one number is needed")
        return _number(self.value(name), f"variable {name}")

    def python(self, name: str, values: list[Value]) -> float:
        """``py_name(values)``: the Python function of a variable of style python with other arguments than its own."""
        if any(isinstance(v, np.ndarray) for v in values):
            raise InputError(f"py_{name}(): every argument must be one number")
        return _number(self._called(name, [float(v) for v in values]), f"py_{name}()")

    def _called(self, name: str, values: list[float] | None) -> str:
        variable = self.find(name)
        if variable.style != "python":
            raise InputError(f"py_{name}(): variable {name} has style {variable.style}, not python")
        if self.provider is None:
            raise InputError(f"variable {name}: there is no Python function {variable.text}")
        return self._guarded(name, lambda: self.provider.python(variable.text, values))

    def vector(self, name: str) -> np.ndarray:
        """The values of a vector-style variable."""
        variable = self.find(name)
        if variable.style != "vector":
            raise InputError(f"variable {name} of style {variable.style} is no vector")
        if variable.values is not None:
            return variable.values
        value = self._guarded(name, lambda: Parser(self, variable.text, "vector").result())
        if not isinstance(value, np.ndarray):
            raise InputError(f"variable {name}: the formula {variable.text!r} gives one number where a vector is needed")
        return value

    def element(self, name: str, *index: int) -> float:
        """``v_name[index]``, counted from 1: of a vector, or of the atom with that id."""
        if self.find(name).style != "vector" or len(index) > 1:
            return self.evaluate(f"v_{name}{''.join(f'[{i}]' for i in index)}")
        values = self.vector(name)
        if not 1 <= index[0] <= len(values):
            raise InputError(f"v_{name}[{index[0]}]: variable {name} has {len(values)} elements")
        return float(values[index[0] - 1])

    def leading_number(self, name: str) -> float:
        """The number that the text of a variable begins with."""
        text = self.value(name)
        match = re.match(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text)
        return _number(match[0] if match else text, f"variable {name}")

    def _guarded(self, name: str, compute: Callable[[], Any]) -> Any:
        if name in self._active:
            raise InputError(f"variable {name} has a circular dependency: {' -> '.join([*self._active, name])}")
        self._active.append(name)
        try:
            return compute()
        except InputError as e:
            if not e.message.startswith("variable "):
                e.message = f"variable {name}: {e.message}"
                e.args = (e.message,)
            raise
        finally:
            self._active.pop()

    def evaluate(self, formula: str) -> float:
        """The value of an equal-style formula."""
        return float(Parser(self, formula).result())

    def per_atom(self, name: str, n: int) -> np.ndarray:
        """The values (n,) of an atom-style variable, by atom row."""
        variable = self.find(name)
        if variable.style == "atomfile":
            ids, given = self.provider.atoms("id"), variable.sets[variable.current]
            unknown = given.keys() - set(ids.astype(int).tolist())
            if unknown:
                raise InputError(f"variable {name}: there is no atom {min(unknown)}, which the file names")
            return np.array([given.get(int(id), 0.0) for id in ids])
        if variable.style != "atom":
            return np.full(n, self.number(name))
        value = self._guarded(name, lambda: Parser(self, variable.text, "atom").result())
        return np.broadcast_to(np.asarray(value, float), (n,)).copy()

    def references(self, formula: str) -> set[str]:
        """Every name a formula uses, through all variables it refers to: keywords, ``c_ID``, ``f_ID``."""
        found, todo = set(), [formula]
        while todo:
            for name in re.findall(r"[A-Za-z_]\w*", todo.pop()):
                if name not in found:
                    found.add(name)
                    variable = self.table.get(name[2:]) if name.startswith("v_") else None
                    if variable is not None and variable.style in (*FORMULAS, "format"):
                        todo.append(variable.text if variable.style != "format" else "v_" + variable.words[0])
        return found

    def random(self, kind: str, seed: int) -> Marsaglia:
        """The one generator of all equal-style (or atom-style) variables; the first seed counts."""
        if kind not in self._random:
            if seed <= 0:
                raise InputError(f"random number seed must be a positive whole number, got {seed}")
            self._random[kind] = Marsaglia(seed)
        return self._random[kind]


class Count(Sequence):
    """The numbers from `first` to `last` as texts, filled up with zeros to `width` digits; none is stored."""

    def __init__(self, first: int, last: int, width: int):
        self.numbers, self.width = range(first, last + 1), width

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, k: int) -> str:
        return str(self.numbers[k]).zfill(self.width)


def _loop(name: str, style: str, words: list[str]) -> Sequence[str]:
    """``loop N [pad]``, ``loop N1 N2 [pad]``; ``uloop`` has only the first of them."""
    pad = bool(words) and words[-1] == "pad"
    bounds = words[:-1] if pad else words
    try:
        first, last = (1, int(bounds[0])) if len(bounds) == 1 else (int(bounds[0]), int(bounds[1]))
    except (ValueError, IndexError):
        first, last = 1, 0
    if last > LARGEST:
        raise InputError(f"variable {name} {style}: {last} is too large")
    if len(bounds) not in ((1, 2) if style == "loop" else (1,)) or first > last or last < 0:
        form = "N or N1 N2 with N1 <= N2" if style == "loop" else "N"
        raise InputError(f"variable {name} {style} needs {form}, and optionally pad; got {' '.join(words) or 'nothing'}")
    width = len(str(last)) if pad else 0
    return Count(first, last, width)


def _one(name: str, style: str, words: list[str]) -> str:
    if len(words) != 1:
        raise InputError(f"variable {name} {style} needs a file name, got {len(words)} values")
    return words[0]


def _read_lines(path: str) -> list[str]:
    """The lines of a file without comments and blank lines."""
    try:
        with open(path, encoding="utf-8", errors="replace") as f:
            lines = [text for line in f if (text := line.partition("#")[0].strip())]
    except (OSError, ValueError) as e:
        raise InputError(f"variable: cannot open file {path}: {getattr(e, 'strerror', None) or e}") from None
    if not lines:
        raise InputError(f"variable: file {path} has no values")
    return lines


def _read_sets(path: str) -> list[dict[int, float]]:
    """Sets of ``id value``, each with its number of lines before it."""
    lines, sets, at = _read_lines(path), [], 0
    while at < len(lines):
        try:
            count = int(lines[at].split()[0])
            rows = [line.split() for line in lines[at + 1:at + 1 + count]]
            sets.append({int(id): float(value) for id, value in rows})
        except ValueError:
            raise InputError(f"variable: file {path} must have a count and then as many lines with an atom id and a value") from None
        if count < 0 or len(rows) != count:
            raise InputError(f"variable: file {path} announces {count} lines with atom ids where there are {len(rows)}")
        at += 1 + count
    return sets


def _listed(name: str, text: str) -> np.ndarray:
    """The numbers of ``[1,2,3]``."""
    if not text.endswith("]"):
        raise InputError(f"variable {name} vector: missing ] in {text}")
    inside = text[1:-1].strip()
    return np.array([_number(w, f"variable {name} vector") for w in inside.split(",")] if inside else [])


def _number(text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value) or "_" in text:
        raise InputError(f"{what}: {text!r} is not a number") from None
    return value


__all__ = ["Clock", "Provider", "Variable", "Variables"]
