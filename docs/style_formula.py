"""The energy of a style as an expression for the lepton styles, found by running its function on numbers that remember how they came about.

Comparisons are decided by the values that occur; where both answers occur, both branches are followed and joined by ``select``.
"""
from __future__ import annotations

import math
import re
from collections.abc import Callable
from types import FunctionType

import numpy as np

MOST = 32       # branches


class Untraceable(Exception):
    """Why a function has no expression."""


class Tape:
    """The operations of one run: definitions by name, and the comparisons whose answer was a matter of choice."""

    def __init__(self, label: str, choices: tuple[bool, ...], n: int):
        self.label, self.choices, self.taken = label, choices, []
        self.text: dict[str, str] = {}
        self.active = np.ones(n, bool)      # values that take this way

    def define(self, text: str, values) -> Traced:
        name = f"{self.label}{len(self.text)}"
        self.text[name] = text
        return Traced(self, name, values)

    def decide(self, answer: np.ndarray, condition: Callable[[], str]) -> bool:
        """`condition` gives an expression that is 1 where `answer` is true and 0 elsewhere."""
        here = answer[self.active]
        if here.all() or not here.any():
            return bool(here.size and here.all())
        k = len(self.taken)
        choice = self.choices[k] if k < len(self.choices) else True
        self.taken.append((condition(), choice))
        self.active = self.active & (answer if choice else ~answer)
        return choice


class Traced:
    """A number of a tape: its name and the values it has."""

    __array_ufunc__ = None      # numpy's numbers leave arithmetic to this class

    def __init__(self, tape: Tape, name: str, values):
        self.tape, self.name, self.values = tape, name, np.asarray(values)

    def binary(self, other, form: str, function: Callable, swap: bool = False):
        a, b = (other, self) if swap else (self, other)
        with np.errstate(all="ignore"):
            return self.tape.define(form.format(word(a), word(b)), function(value(a), value(b)))

    def compare(self, other, sign: str) -> bool:
        left, right = self.values, value(other)
        with np.errstate(all="ignore"):
            answer = {"<": left < right, ">": left > right, "<=": left <= right, ">=": left >= right}[sign]
        form = {"<": "(1-step({a}-{b}))", ">": "(1-step({b}-{a}))", "<=": "step({b}-{a})", ">=": "step({a}-{b})"}[sign]
        return self.tape.decide(answer, lambda: form.format(a=word(self), b=word(other)))

    def __add__(self, o): return self.binary(o, "{}+{}", np.add)
    def __radd__(self, o): return self.binary(o, "{}+{}", np.add, True)
    def __sub__(self, o): return self.binary(o, "{}-{}", np.subtract)
    def __rsub__(self, o): return self.binary(o, "{}-{}", np.subtract, True)
    def __mul__(self, o): return self.binary(o, "{}*{}", np.multiply)
    def __rmul__(self, o): return self.binary(o, "{}*{}", np.multiply, True)
    def __truediv__(self, o): return self.binary(o, "{}/{}", np.divide)
    def __rtruediv__(self, o): return self.binary(o, "{}/{}", np.divide, True)
    def __pow__(self, o): return self.binary(o, "{}^{}", np.power)
    def __rpow__(self, o): return self.binary(o, "{}^{}", np.power, True)
    def __neg__(self): return self.tape.define(f"(-{self.name})", -self.values)
    def __pos__(self): return self
    def __abs__(self): return self.tape.define(f"abs({self.name})", np.abs(self.values))
    def __lt__(self, o): return self.compare(o, "<")
    def __gt__(self, o): return self.compare(o, ">")
    def __le__(self, o): return self.compare(o, "<=")
    def __ge__(self, o): return self.compare(o, ">=")

    def __eq__(self, o):
        answer = self.values == value(o)
        if answer.any() and not answer.all():
            raise Untraceable("its function tests for equality")
        return bool(answer.all())

    def __ne__(self, o): return not self == o
    __hash__ = None

    def __float__(self): raise Untraceable("its function does more than arithmetic with its coordinate")
    __int__ = __index__ = __bool__ = __round__ = __float__


def word(x) -> str:
    """An operand in an expression."""
    if isinstance(x, Traced):
        return x.name
    x = float(x)
    if not math.isfinite(x):
        raise Untraceable("its function is not finite somewhere")
    text = str(int(x)) if x == int(x) and abs(x) < 1e6 else repr(x)
    return f"({text})" if x < 0.0 else text


def value(x):
    return x.values if isinstance(x, Traced) else x


FORMS = {"exp": ("exp({})", np.exp), "log": ("log({})", np.log), "sqrt": ("sqrt({})", np.sqrt), "sin": ("sin({})", np.sin),
         "cos": ("cos({})", np.cos), "tan": ("tan({})", np.tan), "acos": ("acos({})", np.arccos), "asin": ("asin({})", np.arcsin),
         "atan": ("atan({})", np.arctan), "tanh": ("tanh({})", np.tanh), "sinh": ("sinh({})", np.sinh), "cosh": ("cosh({})", np.cosh),
         "expm1": ("(exp({})-1)", np.expm1), "log1p": ("log(1+{})", np.log1p), "fabs": ("abs({})", np.abs),
         "erf": ("erf({})", np.vectorize(math.erf)), "erfc": ("erfc({})", np.vectorize(math.erfc)),
         "degrees": (f"({{}}*{180.0 / math.pi!r})", np.degrees), "radians": (f"({{}}*{math.pi / 180.0!r})", np.radians)}
TWO = {"pow": ("{}^{}", np.power), "atan2": ("atan2({},{})", np.arctan2),
       "copysign": ("(abs({})*(2*step({})-1))", np.copysign)}


class Functions:
    """Stands for the module `math` in a function that is traced."""

    def __getattr__(self, name):
        plain = getattr(math, name)
        if not callable(plain):
            return plain

        def function(*args):
            if not any(isinstance(a, Traced) for a in args):
                return plain(*args)
            first = next(a for a in args if isinstance(a, Traced))
            if name == "isfinite":
                return bool(np.isfinite(first.values[first.tape.active]).all())
            if name not in FORMS and name not in TWO:
                raise Untraceable(f"the function {name} is not one of lepton's")
            form, values = FORMS.get(name) or TWO[name]
            with np.errstate(all="ignore"):
                return first.tape.define(form.format(*map(word, args)), values(*map(value, args)))
        return function


def traced(function: Callable, known: dict | None = None) -> Callable:
    """The same function, and those it calls, with `Functions` in the place of `math`."""
    known = {} if known is None else known
    function = getattr(function, "py_func", function)
    if function in known:
        return known[function]
    names = dict(function.__globals__)
    twin = known[function] = FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)
    for name in function.__code__.co_names:
        used = names.get(name)
        if used is math:
            names[name] = Functions()
        elif isinstance(getattr(used, "py_func", used), FunctionType):
            names[name] = traced(used, known)
    return twin


def expression(energy: Callable, variable: str, values: np.ndarray) -> str:
    """The expression of ``energy(x)`` in the name `variable`.

    Parameters
    ----------
    energy : callable
        Takes a `Traced` number and returns one, or a plain number.
    values : (n,)
        What the variable can be.

    Raises
    ------
    Untraceable
        The function has no expression; the message says why.
    """
    definitions: dict[str, str] = {}
    count = 0

    def follow(choices: tuple[bool, ...]) -> str:
        nonlocal count
        tape = Tape(f"b{count}t", choices, len(values))
        count += 1
        if count > MOST:
            raise Untraceable("its function has too many branches")
        try:
            result = word(energy(Traced(tape, variable, values)))
        except (TypeError, AttributeError, IndexError, OverflowError) as e:
            raise Untraceable(f"its function is more than a formula ({type(e).__name__})") from None
        if len(tape.taken) <= len(choices):
            definitions.update(tape.text)
            return result
        condition, _ = tape.taken[len(choices)]
        definitions.update(tape.text)
        yes, no = follow((*choices, True)), follow((*choices, False))
        return f"select({condition},{yes},{no})"

    text = follow(())
    kept, wanted = [], set(re.findall(r"b\d+t\d+", text))
    for name in reversed(definitions):
        if name in wanted:
            kept.append(f"{name}={definitions[name]}")
            wanted |= set(re.findall(r"b\d+t\d+", definitions[name]))
    return ";".join([text, *kept])
