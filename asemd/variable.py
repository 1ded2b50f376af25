"""Variables: their texts, and the numbers that their formulas give.

Source: the LAMMPS manual page of ``variable``.
"""
from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError, nearest
from asemd.formula import Parser, Provider
from asemd.formula_functions import Clock, Value
from asemd.marsaglia import Marsaglia
from asemd.words import LARGEST

STYLES = ("delete", "index", "loop", "string", "getenv", "format", "internal", "equal", "atom")


@dataclass
class Variable:
    """One variable: its style, its texts and which of them is current."""

    style: str
    words: list[str]
    current: int = 0

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
            if style in ("index", "loop"):
                return
            if old.style != style:
                raise InputError(f"variable {name} exists with style {old.style}; delete it before it becomes style {style}")
        self.table[name] = Variable(style, self._words(name, style, words))

    def _words(self, name: str, style: str, words: list[str]) -> Sequence[str]:
        if style == "loop":
            return _loop(name, words)
        need = {"format": 2, "string": 1, "getenv": 1, "internal": 1}
        if not words or len(words) != need.get(style, len(words)):
            raise InputError(f"variable {name} {style} needs {need.get(style, 'at least 1')} value(s), got {len(words)}")
        if style in ("equal", "atom"):
            return [" ".join(words)]
        if style == "internal":
            _number(words[0], f"variable {name} internal")
        if style == "format" and not re.fullmatch(r"%[-+ 0#]*\d*(\.\d+)?[eEfFgG]", words[1]):
            raise InputError(f"variable {name}: format {words[1]} must be one of %e, %f, %g")
        return list(words)

    def set(self, name: str, text: str) -> None:
        """Set a string or internal variable to another text."""
        self.find(name).words[:] = [text]

    def advance(self, names: list[str]) -> bool:
        """``next``: step the variables on; those that are exhausted go. Returns whether they were exhausted."""
        kinds = {self.find(n).style for n in names}
        if len(kinds) > 1:
            raise InputError("next: all variables must have the same style")
        if kinds - {"index", "loop"}:
            raise InputError(f"next: a variable of style {kinds.pop()} has no next value")
        done = False
        for name in names:
            variable = self.table[name]
            variable.current += 1
            if variable.current >= len(variable.words):
                done = True
        if done:
            for name in names:
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
        if variable.style == "equal":
            return f"{self.number(name):.15g}"
        if variable.style == "internal":
            return f"{float(variable.text):.15g}"
        if variable.style == "getenv":
            return os.environ.get(variable.text, "")
        if variable.style == "format":
            return variable.words[1] % self.number(variable.text)
        if variable.style == "atom":
            raise InputError(f"variable {name} has style atom and no text to put here")
        return variable.text

    def number(self, name: str) -> float:
        """The value of a variable as one number."""
        variable = self.find(name)
        if variable.style == "equal":
            return self._guarded(name, lambda: self.evaluate(variable.text))
        if variable.style == "atom":
            raise InputError(f"variable {name} has style atom where one number is needed")
        return _number(self.value(name), f"variable {name}")

    def _guarded(self, name: str, compute: Callable[[], Value]) -> Value:
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
        return float(Parser(self, formula, per_atom=False).result())

    def per_atom(self, name: str, n: int) -> np.ndarray:
        """The values (n,) of an atom-style variable, by atom row."""
        variable = self.find(name)
        if variable.style != "atom":
            return np.full(n, self.number(name))
        value = self._guarded(name, lambda: Parser(self, variable.text, per_atom=True).result())
        return np.broadcast_to(np.asarray(value, float), (n,)).copy()

    def references(self, formula: str) -> set[str]:
        """Every name a formula uses, through all variables it refers to: keywords, ``c_ID``, ``f_ID``."""
        found, todo = set(), [formula]
        while todo:
            for name in re.findall(r"[A-Za-z_]\w*", todo.pop()):
                if name not in found:
                    found.add(name)
                    variable = self.table.get(name[2:]) if name.startswith("v_") else None
                    if variable is not None and variable.style in ("equal", "atom", "format"):
                        todo.append(variable.text if variable.style != "format" else "v_" + variable.text)
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


def _loop(name: str, words: list[str]) -> Sequence[str]:
    """``loop N [pad]``, ``loop N1 N2 [pad]``."""
    pad = bool(words) and words[-1] == "pad"
    bounds = words[:-1] if pad else words
    try:
        first, last = (1, int(bounds[0])) if len(bounds) == 1 else (int(bounds[0]), int(bounds[1]))
    except (ValueError, IndexError):
        first, last = 1, 0
    if last > LARGEST:
        raise InputError(f"variable {name} loop: {last} is too large")
    if len(bounds) not in (1, 2) or first > last or last < 0:
        raise InputError(f"variable {name} loop needs N or N1 N2 with N1 <= N2, and optionally pad; got {' '.join(words) or 'nothing'}")
    width = len(str(last)) if pad else 0
    return Count(first, last, width)


def _number(text: str, what: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{what}: {text!r} is not a number") from None


__all__ = ["Clock", "Provider", "Variable", "Variables"]
