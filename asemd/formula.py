"""The formula language of variables, evaluated with what a `Provider` hands in.

Source: the LAMMPS manual page of ``variable``; operators, functions and rounding as the program has them
(unary minus binds tighter than ``^``, everything groups to the left, ``round`` is ``floor(x + 1/2)``). Functions that take names
instead of numbers are in `asemd.formula_names`.
"""
from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Protocol

import numpy as np

from asemd.errors import InputError, nearest
from asemd.formula_functions import BINARY, GROUP, MATH, STEP, Clock, Value, each, whole
from asemd.formula_names import NAMED

if TYPE_CHECKING:
    from asemd.variable import Variables

CONSTANTS = {"PI": math.pi, "yes": 1.0, "on": 1.0, "true": 1.0, "no": 0.0, "off": 0.0, "false": 0.0}
ATOM_VECTORS = ("id", "mass", "type", "mol", "radius", "q", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz")
LARGEST_SEED = 2**31 - 1
VERSION = 20250722.0       # the LAMMPS version whose input language this is
TOKEN = re.compile(r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)"
                   r"|(?P<op>==|!=|<=|>=|&&|\|\||\|\^|[-+*/%^!<>()\[\],:]))")


class Provider(Protocol):
    """Where a formula gets its physical quantities; each method raises `InputError` for what does not exist."""

    def thermo(self, keyword: str) -> float: ...
    def reference(self, kind: str, id: str, index: list[int]) -> float: ...
    def per_atom(self, kind: str, id: str, column: int | None) -> np.ndarray: ...
    def vector(self, kind: str, id: str, column: int | None) -> np.ndarray: ...
    def has(self, kind: str, id: str, what: str) -> bool: ...
    def atoms(self, name: str) -> np.ndarray: ...
    def property(self, name: str, column: int | None) -> np.ndarray: ...
    def row(self, atom_id: int) -> int: ...
    def group(self, name: str) -> np.ndarray: ...
    def region(self, name: str) -> np.ndarray: ...
    def group_function(self, name: str, mask: np.ndarray, word: str | None) -> float: ...
    def clock(self) -> Clock: ...
    def defined(self, category: str, name: str) -> bool: ...
    def available(self, category: str, name: str) -> bool: ...
    def active(self, category: str, name: str) -> bool: ...
    def setting(self, name: str) -> int: ...
    def type_of(self, kind: str, label: str) -> int | None: ...
    def python(self, function: str, values: list[float] | None) -> str: ...


class Parser:
    """Recursive descent over one formula; the depth of a rule is its precedence.

    Parameters
    ----------
    variables : Variables
    formula : str
    style : str
        ``equal`` for one number, ``atom`` for one per atom, ``vector`` for several; arrays of the other kind are refused.
    """

    def __init__(self, variables: Variables, formula: str, style: str = "equal"):
        self.variables, self.formula, self.style = variables, formula, style
        self.at, self.kind, self.token = 0, "", ""
        self.start = 0
        self.advance()

    @property
    def wants_atoms(self) -> bool:
        return self.style == "atom"

    @property
    def provider(self) -> Provider:
        if self.variables.provider is None:
            raise InputError(f"formula {self.formula!r} needs a simulation")
        return self.variables.provider

    def advance(self) -> None:
        rest = self.formula[self.at:]
        if not rest.strip():
            self.kind, self.token, self.start = "end", "", len(self.formula)
            return
        match = TOKEN.match(rest)
        if not match:
            raise InputError(f"invalid character {rest.strip()[0]!r} in formula {self.formula!r}")
        self.kind, self.token = match.lastgroup, match[match.lastgroup]
        self.start = self.at + match.start(match.lastgroup)
        self.at += match.end()

    def take(self, token: str) -> None:
        if self.token != token or self.kind != "op":
            found = f", found {self.token!r}" if self.token else " at the end"
            raise InputError(f"invalid formula {self.formula!r}: expected {token!r}{found}")
        self.advance()

    def result(self) -> Value:
        try:
            value = self.binary(0)
        except RecursionError:
            raise InputError("a formula is nested too deeply") from None
        if self.kind != "end":
            raise InputError(f"invalid formula {self.formula!r}: unexpected {self.token!r}")
        if isinstance(value, np.ndarray) and self.style == "equal":
            raise InputError(f"formula {self.formula!r} gives several values where one number is needed")
        return value

    def binary(self, level: int) -> Value:
        if level == len(BINARY):
            return self.unary()
        value = self.binary(level + 1)
        while self.kind == "op" and self.token in BINARY[level]:
            function = BINARY[level][self.token]
            self.advance()
            value = each(function, value, self.binary(level + 1))
        return value

    def unary(self) -> Value:
        if self.kind == "op" and self.token in "-!":
            sign = self.token
            self.advance()
            value = self.unary()
            if sign == "!":
                return each(lambda a: float(a == 0.0), value)
            return 0.0 - value
        return self.primary()

    def primary(self) -> Value:
        if self.kind == "number":
            value = float(self.token)
            self.advance()
            return value
        if self.kind == "op" and self.token == "(":
            self.advance()
            value = self.binary(0)
            self.take(")")
            return value
        if self.kind != "name":
            place = f"before {self.token!r}" if self.token else "at the end"
            raise InputError(f"invalid formula {self.formula!r}: a value is missing {place}")
        name = self.token
        self.advance()
        if self.kind == "op" and self.token == "(":
            return self.call(name)
        if name[:2] in ("c_", "f_", "v_", "C_", "F_"):
            return self.reference(name[0], name[2:])
        if name in CONSTANTS:
            return CONSTANTS[name]
        if re.match(r"[id]2?_", name):
            return self.property(name)
        if name == "version":
            return VERSION
        if name in ATOM_VECTORS:
            index = self.index()
            values = self.provider.atoms(name)
            if index is None:
                return self.atom_values(values, name)
            return float(values[self.provider.row(index)])
        return float(self.provider.thermo(name))

    def property(self, name: str) -> Value:
        """``d_name``, ``d2_name[column]`` and those of one atom, ``d_name[id]``, ``d2_name[id][column]``."""
        index = [i for i in (self.index(), self.index()) if i is not None]
        columns = name[1] == "2"
        if len(index) - columns not in (0, 1):
            raise InputError(f"invalid formula {self.formula!r}: {name} needs {'a column' if columns else 'no more than an atom id'}")
        values = self.provider.property(name, index[-1] if columns else None)
        if len(index) > columns:
            return float(values[self.provider.row(index[0])])
        return self.atom_values(values, name)

    def index(self) -> int | None:
        """``[i]``, where i is a whole number or ``v_name``."""
        if self.kind != "op" or self.token != "[":
            return None
        self.advance()
        if self.kind == "number" and self.token.isdigit():
            value = int(self.token)
        elif self.kind == "name" and self.token.startswith("v_"):
            value = whole(self.variables.number(self.token[2:]), f"index {self.token}")
        else:
            raise InputError(f"invalid formula {self.formula!r}: an index must be a whole number or v_name")
        if value <= 0:
            raise InputError(f"invalid formula {self.formula!r}: an index must be positive")
        self.advance()
        self.take("]")
        return value

    def atom_values(self, values: np.ndarray, name: str) -> np.ndarray:
        """One value per atom, where the formula may have them."""
        if not self.wants_atoms:
            needed = "one number is" if self.style == "equal" else "a vector that belongs to no atom is"
            raise InputError(f"{name} gives one value per atom where {needed} needed")
        return values

    def reference(self, kind: str, id: str) -> Value:
        """``c_ID``, ``f_ID`` and ``v_name`` with up to two indices; a capital C or F asks for the values of one atom."""
        index = [i for i in (self.index(), self.index()) if i is not None]
        shown = f"{kind}_{id}{''.join(f'[{i}]' for i in index)}"
        if kind == "v":
            return self.variable(id, index)
        p, capital, kind = self.provider, kind.isupper(), kind.lower()
        count = len(index)
        if not capital:
            if self.style == "vector" and count < 2 and p.has(kind, id, ("vector", "array")[count]):
                return p.vector(kind, id, index[0] if index else None)
            if self.style == "vector" and count == 1:
                raise InputError(f"{shown}: in a vector an index means a column of a global array, which {kind}_{id} does not have")
            if p.has(kind, id, ("scalar", "vector", "array")[count]):
                return float(p.reference(kind, id, index))
            if p.has(kind, id, "per_atom") and (not index or (self.wants_atoms and count == 1)):
                return self.atom_values(p.per_atom(kind, id, index[0] if index else None), shown)
        if not index or not p.has(kind, id, "per_atom"):
            return float(p.reference(kind, id, index))      # which says what is missing
        return float(p.per_atom(kind, id, index[1] if count == 2 else None)[p.row(index[0])])

    def variable(self, name: str, index: list[int]) -> Value:
        style = self.variables.find(name).style
        if style in ("atom", "atomfile"):
            if not index and self.style != "atom":
                raise InputError(f"variable {name} has style {style} where one number is needed")
            values = self.variables.per_atom(name, self.provider.atoms("id").size)
            return float(values[self.provider.row(index[0])]) if index else values
        if style == "vector":
            if index:
                return self.variables.element(name, index[0])
            if self.style != "vector":
                raise InputError(f"variable {name} has style vector where {'a number' if self.style == 'equal' else 'atoms'} must be")
            return self.variables.vector(name)
        if index:
            raise InputError(f"v_{name}[{index[0]}]: variable {name} of style {style} has no elements")
        return self.variables.number(name)

    def words(self) -> list[str]:
        """The plain words between the parentheses of a function that takes names."""
        depth, end = 1, self.start + 1
        while end < len(self.formula) and depth:
            depth += {"(": 1, ")": -1}.get(self.formula[end], 0)
            end += 1
        if depth:
            raise InputError(f"invalid formula {self.formula!r}: missing )")
        inside = self.formula[self.start + 1:end - 1]
        self.at = end
        self.advance()
        return [w.strip() for w in inside.split(",")]

    def values(self) -> list[Value]:
        self.take("(")
        out = [self.binary(0)]
        while self.kind == "op" and self.token == ",":
            self.advance()
            out.append(self.binary(0))
        self.take(")")
        return out

    def call(self, name: str) -> Value:
        if name in MATH:
            return each(MATH[name][1], *self.counted(name, MATH[name][0]))
        if name in STEP:
            clock = self.provider.clock()
            count, function = STEP[name]
            return each(lambda *v: function(clock, *v), *self.counted(name, count))
        if name in ("random", "normal"):
            return self.noise(name, self.counted(name, 3))
        if name in GROUP:
            return self.group(name, self.words())
        if name in NAMED:
            return NAMED[name](self, name, self.words())
        if name.startswith("py_"):
            return self.variables.python(name[3:], self.values())
        known = [*MATH, *STEP, *GROUP, *NAMED, "random", "normal"]
        raise InputError(f"unknown function {name}() in formula {self.formula!r}{nearest(name, known)}")

    def arguments(self, name: str, given: list, count: int) -> list:
        if len(given) != count:
            raise InputError(f"{name}() takes {count} argument{'s' * (count != 1)}, got {len(given)}")
        return given

    def counted(self, name: str, count: int) -> list[Value]:
        return self.arguments(name, self.values(), count)

    def noise(self, name: str, given: list[Value]) -> Value:
        a, b, seed = given
        if isinstance(seed, np.ndarray):
            raise InputError(f"{name}(): the seed must be one number")
        if not abs(seed) <= LARGEST_SEED:
            raise InputError(f"{name}(): {seed:g} is no seed")
        source = self.variables.random("atom" if self.wants_atoms else "equal", int(seed))
        if name == "normal":
            return each(lambda mean, sigma: mean + sigma * source.gaussian(), *self.spread(a, b))
        return each(lambda low, high: source.uniform() * (high - low) + low, *self.spread(a, b))

    def spread(self, a: Value, b: Value) -> tuple[Value, Value]:
        """In an atom-style formula every atom draws its own number."""
        if self.wants_atoms and not isinstance(a, np.ndarray):
            return np.full(self.provider.atoms("id").size, a), b
        return a, b

    def group(self, name: str, words: list[str]) -> float:
        base = 1 + GROUP[name]
        if len(words) not in (base, base + 1):
            raise InputError(f"{name}() takes group{', direction' * GROUP[name]} and optionally region, got {','.join(words)}")
        mask = self.provider.group(words[0])
        if len(words) > base:
            mask = mask & self.provider.region(words[-1])
        return self.provider.group_function(name, mask, words[1] if GROUP[name] else None)
