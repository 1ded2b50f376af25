"""Formulas of the lepton styles: parsed, differentiated by one variable and written as source that compiles.

The language is that of LAMMPS's lepton styles: ``+ - * / ^`` (``^`` groups to the right and binds tighter than the minus sign, which
binds tighter than ``*``), functions, and definitions of intermediate values after semicolons. The parser writes a program for
`asemd.calculus`. Constants become arguments of the function, so that formulas which differ only in numbers share one piece of code.
Source: manual pages of bond_style lepton and pair_style lepton.
"""
from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from asemd.calculus import source_of
from asemd.errors import InputError, nearest

TOKEN = re.compile(r"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>[-+*/^(),])", re.ASCII)
VARIABLE = re.compile(r"(?<![A-Za-z0-9_])v_(\w+)")
ZBL = ("zbl energy", "zbl length")     # constants of the function zbl; it exists where they are given
ARGUMENT = "x"      # the variable in the written source
FUNCTIONS = dict.fromkeys("sqrt exp log sin cos sec csc tan cot asin acos atan sinh cosh tanh erf erfc step delta square cube recip abs "
                          "floor ceil".split(), 1) | {"atan2": 2, "min": 2, "max": 2, "select": 3}      # and their numbers of arguments
ARITHMETIC = {"add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": np.divide, "neg": operator.neg, "pow": np.power}


@dataclass(eq=False)
class Node:
    """A part of a formula: a `word` of the program, or (also) a constant `value`; `given`: the value may be another one later."""

    word: str = ""
    value: float | None = None
    given: bool = False


class Program:
    """The operations of one formula in order, and the constants ``c0``, ``c1``, ... that they name."""

    def __init__(self):
        self.lines: dict[str, str] = {}     # operation: its word
        self.constants: list[float] = []

    def word(self, node: Node) -> str:
        """What operations call the node; 1 stays 1, for ``1 - cos(x)`` and the like."""
        if not node.word and node.value in (1.0, -1.0) and not node.given:
            node.word = f"{node.value:.0f}"
        if not node.word:
            node.word = f"c{len(self.constants)}"
            self.constants.append(node.value)
        return node.word

    def do(self, name: str, *args: Node) -> Node:
        if name in ARITHMETIC and all(a.value is not None for a in args):
            with np.errstate(all="ignore"):
                value = float(ARITHMETIC[name](*(np.float64(a.value) for a in args)))
            return Node(value=value, given=any(a.given for a in args))
        words = [self.word(a) for a in args[:1]]
        exponent = args[1].value if name == "pow" else None
        if exponent is not None:        # exponents belong to the code
            words.append(str(int(exponent)) if exponent == int(exponent) and abs(exponent) < 1000.0 else repr(exponent))
            if abs(exponent) == 0.5:
                root = self.do("sqrt", args[0])
                return root if exponent > 0.0 else self.do("div", Node(value=1.0), root)
        else:
            words += [self.word(a) for a in args[1:]]
        return Node(self.lines.setdefault(" ".join([name, *words]), f"t{len(self.lines)}"))


class Parser:
    """Recursive descent over one formula without blanks; `start` is where it begins in `text`, `given` has values of names like v_k."""

    def __init__(self, program: Program, text: str, start: int, names: Mapping[str, Node], late: set[str], given: Mapping[str, float]):
        self.do, self.text, self.names, self.late, self.given = program.do, text, names, late, given
        self.at, self.end = start, text.find(";", start) % (len(text) + 1)
        self.kind = self.token = ""
        self.advance()

    def wrong(self, problem: str, at: int | None = None) -> InputError:
        at = self.begin if at is None else at
        return InputError(f"expression {self.text!r}: {problem} at character {at + 1}")

    def advance(self) -> None:
        self.begin = self.at
        if self.at >= self.end:
            self.kind = self.token = ""
            return
        match = TOKEN.match(self.text, self.at, self.end)
        if not match:
            raise self.wrong(f"{self.text[self.at]!r} has no meaning")
        self.kind, self.token, self.at = match.lastgroup, match[0], match.end()

    def formula(self) -> Node:
        node = self.sum()
        if self.token == ")":
            raise self.wrong("')' without a '('")
        if self.token:
            raise self.wrong(f"an operator is missing before {self.token!r}" if self.token != "," else "',' outside a function")
        return node

    def sum(self) -> Node:
        node = self.product()
        while self.token and self.token in "+-":
            operation = "add" if self.token == "+" else "sub"
            self.advance()
            node = self.do(operation, node, self.product())
        return node

    def product(self) -> Node:
        node = self.signed()
        while self.token and self.token in "*/":
            operation = "mul" if self.token == "*" else "div"
            self.advance()
            node = self.do(operation, node, self.signed())
        return node

    def signed(self) -> Node:
        if self.token == "-":
            self.advance()
            return self.do("neg", self.signed())
        negative = self.given.get(self.token, 0.0) < 0.0     # v_k^2 with k = -3 reads as -3^2
        node = self.primary()
        if self.token == "^":
            self.advance()
            node = self.do("pow", node, self.signed())
        return self.do("neg", node) if negative else node

    def primary(self) -> Node:
        token, begin = self.token, self.begin
        if self.kind == "number":
            self.advance()
            if math.isinf(float(token)):
                raise self.wrong(f"the number {token} is too large", begin)
            return Node(value=float(token))
        if self.kind == "name":
            self.advance()
            return self.call(token, begin) if self.token == "(" else self.name(token, begin)
        if token == "(":
            self.advance()
            node = self.sum()
            self.close(begin)
            return node
        raise self.wrong(f"a value is missing before {token!r}" if token else "a value is missing")

    def close(self, begin: int) -> None:
        if self.token != ")":
            if self.token:
                raise self.wrong(f"an operator is missing before {self.token!r}" if self.token != "," else "unexpected ','")
            raise self.wrong("'(' without a ')'", begin)
        self.advance()

    def name(self, name: str, begin: int) -> Node:
        if name in self.given:
            return Node(value=abs(self.given[name]), given=True)
        if name in self.names:
            return self.names[name]
        if name in self.late:
            raise self.wrong(f"{name} is used after its definition; definitions follow all uses", begin)
        if name in FUNCTIONS:
            raise self.wrong(f"the function {name} needs its argument in parentheses", begin)
        if VARIABLE.match(name):
            raise self.wrong(f"{name} is a variable of a script and has no value here", begin)
        known = [*self.names, *FUNCTIONS]
        raise self.wrong(f"unknown name {name}{nearest(name, known)}", begin)

    def call(self, name: str, begin: int) -> Node:
        functions = FUNCTIONS if ZBL[0] not in self.given else {**FUNCTIONS, "zbl": 3}
        if name not in functions:
            raise self.wrong(f"unknown function {name}{nearest(name, functions)}", begin)
        bracket, args = self.begin, []
        while not args or self.token == ",":
            self.advance()
            args.append(self.sum())
        self.close(bracket)
        count = functions[name]
        if len(args) != count:
            raise self.wrong(f"{name} needs {count} argument{'s' * (count != 1)}, got {len(args)}", begin)
        if name == "recip":
            return self.do("div", Node(value=1.0), *args)
        return self.do(name, *args, *(Node(value=self.given[k], given=True) for k in ZBL if name == "zbl"))


def condense(text: str) -> str:
    """The expression without blanks and quotation marks, which mean nothing in it."""
    return re.sub(r"[\s'\"]", "", text)


def parse(text: str, variable: str, given: Mapping[str, float], symbols: Mapping[str, str] = MappingProxyType({})) -> Program:
    """The program of a condensed expression, whose last line is its value; `given` are the values of variables, ``{"v_k": 2.0}``,
    `symbols` names that stand for constants of these names (c...) whose values come later."""
    program = Program()
    names: dict[str, Node] = {variable: Node(ARGUMENT), **{name: Node(word) for name, word in symbols.items()}}
    starts = [m.end() for m in re.finditer(";", text)]
    late = {text[s:].split("=")[0] for s in starts}
    try:
        for start in reversed(starts):
            definition = text[start:].split(";")[0]
            if not definition:
                continue
            name, equals, _ = definition.partition("=")
            if not equals or not re.fullmatch(r"[A-Za-z_]\w*", name):
                raise InputError(f"expression {text!r}: after a semicolon comes a definition such as k=2, got {definition!r}")
            names[name] = Parser(program, text, start + len(name) + 1, names, late, given).formula()
            late.discard(name)
        # a formula that is one number or the variable has a program too
        value = program.word(Parser(program, text, 0, names, late, given).formula())
        program.lines[f"same {value}"] = ""
        return program
    except RecursionError:
        raise InputError(f"expression {text!r} is nested too deeply") from None


@dataclass(frozen=True)
class Compiled:
    """An expression as source.

    Attributes
    ----------
    lines : tuple of str
        Statements that set names from ``x`` and the constants ``p0``, ``p1``, ...
    energy, slope : str
        What the value and its derivative are then.
    constants : tuple of float
        ``p0``, ``p1``, ...
    bend_lines, bend : tuple of str, str
        Statements of the second derivative, and what it is then.
    """

    lines: tuple[str, ...]
    energy: str
    slope: str
    constants: tuple[float, ...]
    bend_lines: tuple[str, ...]
    bend: str

    @property
    def code(self) -> tuple[tuple[str, ...], str, str, tuple[str, ...], str]:
        """What expressions have in common that differ in numbers only."""
        return self.lines, self.energy, self.slope, self.bend_lines, self.bend

    def value(self, x: float) -> float:
        """The value at one place; not finite where it is not defined."""
        names = [ARGUMENT, *(f"p{k}" for k in range(len(self.constants)))]
        source = f"def value({', '.join(names)}):\n" + "".join(f"    {line}\n" for line in (*self.lines, f"return {self.energy}"))
        with np.errstate(all="ignore"):
            return float(compiled_function("value", source)(*map(np.float64, (x, *self.constants))))


def compiled_function(name: str, source: str, module: str = __name__) -> Callable:
    """A function of `module` from written source, with the text as its attribute ``source``."""
    names: dict = {"math": math, "np": np, "__name__": module}
    exec(compile(source, f"<{name}>", "exec"), names)
    names[name].source = source
    return names[name]


@lru_cache(4096)
def differentiate(text: str, variable: str, given: tuple[tuple[str, float], ...] = ()) -> Compiled:
    """Value and derivative of an expression by one variable.

    Parameters
    ----------
    text : str
        Condensed expression.
    variable : str
        Its one free name.
    given : tuple of (str, float)
        Values of names like ``v_k``; they are constants of the source whatever their value.

    Raises
    ------
    InputError
        The expression cannot be read; the message says what is wrong where.
    """
    program = parse(text, variable, dict(given))
    try:
        source = source_of(tuple(program.lines))
    except RecursionError:
        raise InputError(f"expression {text!r} is nested too deeply") from None
    names = ", ".join(f"c{k}" for k in range(len(program.constants)))
    lines = f"def constants({names}):\n    return ({''.join(f'{c}, ' for c in source.constants)})\n"
    with np.errstate(all="ignore"):
        values = compiled_function("constants", lines)(*map(np.float64, program.constants))
    return Compiled(source.lines, source.energy, source.slope, tuple(map(float, values)), source.bend_lines, source.bend)
