"""Operations of a formula as a graph, with their derivatives: what `asemd.expression` parses into and writes source from.

Each rule keeps digits: ``exp(x) - 1``, ``log(1 + x)``, ``1 - cos(x)`` and their relatives become functions without cancellation, the
derivative of tanh is 1/cosh^2. Conventions at jumps and kinks are those of LAMMPS: step(0) = 1, the slope of abs at 0 is 1.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np


class Node(NamedTuple):
    """One operation of a formula.

    Numbers have a `value` and an `origin`: None for numbers of the calculus, where it stands in the text, or text for one that may have
    another value later, so that nothing is made simpler for its sake.
    """

    op: str
    args: tuple[Node, ...] = ()
    value: float = 0.0
    origin: object = None
    number: int = 0         # by age: arguments come first

    def __hash__(self):
        return self.number

    def __eq__(self, other):
        return self is other


class Operation(NamedTuple):
    """What an operation is in source, as a function of numbers, and its derivative: ``slope(graph, node, arguments, their slopes)``."""

    text: str
    value: Callable
    slope: Callable


def _versine(x):
    return 2.0 * np.sin(0.5 * x) ** 2


def _coversine(x):
    return 2.0 * np.cos(0.5 * x) ** 2


ERF = 2.0 / math.sqrt(math.pi)
OPERATIONS = {
    "add": Operation("{} + {}", lambda a, b: a + b, lambda g, n, a, d: g.add(*d)),
    "sub": Operation("{} - {}", lambda a, b: a - b, lambda g, n, a, d: g.sub(*d)),
    "mul": Operation("{} * {}", lambda a, b: a * b, lambda g, n, a, d: g.add(g.mul(d[0], a[1]), g.mul(a[0], d[1]))),
    "div": Operation("{} / {}", np.divide, lambda g, n, a, d: g.div(g.sub(d[0], g.mul(n, d[1])), a[1])),
    "neg": Operation("-{}", lambda a: -a, lambda g, n, a, d: g.neg(d[0])),
    "pow": Operation("np.power({}, {})", np.power, lambda g, n, a, d: g.slope_of_power(n, a, d)),
    "ipow": Operation("", np.power, lambda g, n, a, d: g.mul(g.mul(a[1], g.power(a[0], g.number(a[1].value - 1.0))), d[0])),
    "sqrt": Operation("np.sqrt({})", np.sqrt, lambda g, n, a, d: g.div(d[0], g.mul(g.number(2.0), n))),
    "exp": Operation("np.exp({})", np.exp, lambda g, n, a, d: g.mul(n, d[0])),
    "expm1": Operation("np.expm1({})", np.expm1, lambda g, n, a, d: g.mul(g.call("exp", a[0]), d[0])),
    "log": Operation("np.log({})", np.log, lambda g, n, a, d: g.div(d[0], a[0])),
    "log1p": Operation("np.log1p({})", np.log1p, lambda g, n, a, d: g.div(d[0], g.add(g.number(1.0), a[0]))),
    "sin": Operation("np.sin({})", np.sin, lambda g, n, a, d: g.mul(g.call("cos", a[0]), d[0])),
    "cos": Operation("np.cos({})", np.cos, lambda g, n, a, d: g.neg(g.mul(g.call("sin", a[0]), d[0]))),
    "versine": Operation("2.0 * np.sin(0.5 * {}) ** 2", _versine, lambda g, n, a, d: g.mul(g.call("sin", a[0]), d[0])),
    "coversine": Operation("2.0 * np.cos(0.5 * {}) ** 2", _coversine, lambda g, n, a, d: g.neg(g.mul(g.call("sin", a[0]), d[0]))),
    "tan": Operation("np.tan({})", np.tan, lambda g, n, a, d: g.div(d[0], g.square(g.call("cos", a[0])))),
    "asin": Operation("np.arcsin({})", np.arcsin, lambda g, n, a, d: g.div(d[0], g.side(a[0]))),
    "acos": Operation("np.arccos({})", np.arccos, lambda g, n, a, d: g.neg(g.div(d[0], g.side(a[0])))),
    "atan": Operation("np.arctan({})", np.arctan, lambda g, n, a, d: g.div(d[0], g.add(g.number(1.0), g.square(a[0])))),
    "atan2": Operation("np.arctan2({}, {})", np.arctan2, lambda g, n, a, d: g.div(
        g.sub(g.mul(a[1], d[0]), g.mul(a[0], d[1])), g.add(g.square(a[0]), g.square(a[1])))),
    "sinh": Operation("np.sinh({})", np.sinh, lambda g, n, a, d: g.mul(g.call("cosh", a[0]), d[0])),
    "cosh": Operation("np.cosh({})", np.cosh, lambda g, n, a, d: g.mul(g.call("sinh", a[0]), d[0])),
    "tanh": Operation("np.tanh({})", np.tanh, lambda g, n, a, d: g.div(d[0], g.square(g.call("cosh", a[0])))),
    "erf": Operation("math.erf({})", math.erf, lambda g, n, a, d: g.mul(g.bell(a[0]), d[0])),
    "erfc": Operation("math.erfc({})", math.erfc, lambda g, n, a, d: g.neg(g.mul(g.bell(a[0]), d[0]))),
    "abs": Operation("abs({})", abs, lambda g, n, a, d: g.less(a[0], g.number(0.0), g.neg(d[0]), d[0])),
    "floor": Operation("np.floor({})", np.floor, lambda g, n, a, d: g.number(0.0)),
    "ceil": Operation("np.ceil({})", np.ceil, lambda g, n, a, d: g.number(0.0)),
    "less": Operation("{2} if {0} < {1} else {3}", lambda a, b, p, q: p if a < b else q, lambda g, n, a, d: g.less(a[0], a[1], d[2], d[3])),
    "select": Operation("{1} if {0} != 0.0 else {2}", lambda c, p, q: p if c != 0.0 else q,
                        lambda g, n, a, d: g.select(a[0], d[1], d[2])),
}
# function of the language: number of arguments, and how it is made of operations
FUNCTIONS: dict[str, tuple[int, Callable]] = {name: (1, lambda g, x, name=name: g.call(name, x)) for name in (
    "sqrt exp log sin cos tan asin acos atan sinh cosh tanh erf erfc abs floor ceil".split())}
FUNCTIONS |= {
    "sec": (1, lambda g, x: g.div(g.number(1.0), g.call("cos", x))),
    "csc": (1, lambda g, x: g.div(g.number(1.0), g.call("sin", x))),
    "cot": (1, lambda g, x: g.div(g.call("cos", x), g.call("sin", x))),
    "square": (1, lambda g, x: g.square(x)),
    "cube": (1, lambda g, x: g.power(x, g.number(3.0))),
    "recip": (1, lambda g, x: g.div(g.number(1.0), x)),
    "step": (1, lambda g, x: g.less(x, g.number(0.0), g.number(0.0), g.number(1.0))),
    "delta": (1, lambda g, x: g.select(x, g.number(0.0), g.number(1.0))),
    "atan2": (2, lambda g, y, x: g.call("atan2", y, x)),
    "min": (2, lambda g, a, b: g.less(a, b, a, b)),
    "max": (2, lambda g, a, b: g.less(a, b, b, a)),
    "select": (3, lambda g, c, a, b: g.select(c, a, b)),
}


class Graph:
    """All operations of one formula, each of them once; the methods simplify what costs digits or time, and nothing else."""

    def __init__(self):
        self.nodes: list[Node] = []
        self.known: dict[tuple, Node] = {}

    def make(self, op: str, args: tuple[Node, ...] = (), value: float = 0.0, origin=None) -> Node:
        key = (op, tuple(a.number for a in args), repr(value), origin)
        if key not in self.known:
            self.known[key] = Node(op, args, value, origin, len(self.nodes))
            self.nodes.append(self.known[key])
        return self.known[key]

    def number(self, value: float, origin=None) -> Node:
        return self.make("number", (), float(value), origin)

    def call(self, op: str, *args: Node) -> Node:
        """An operation; of numbers, its value."""
        if op == "log" and args[0].op in ("add", "sub"):
            a, b = args[0].args
            if is_number(a, 1.0):
                return self.call("log1p", b if args[0].op == "add" else self.neg(b))
            if is_number(b, 1.0) and args[0].op == "add":
                return self.call("log1p", a)
        if all(a.op == "number" for a in args):
            with np.errstate(all="ignore"):
                value = float(OPERATIONS[op].value(*(np.float64(a.value) for a in args)))
            origin: object = (op, *((a.value, a.origin) for a in args))
            if any(isinstance(a.origin, str) for a in args):
                origin = f"{op}{[a.origin or a.value for a in args]}"
            elif all(a.origin is None for a in args) and math.isfinite(value):
                origin = None
            return self.number(value, origin)
        return self.make(op, args)

    def add(self, a: Node, b: Node) -> Node:
        if is_number(a, 0.0):
            return b
        if is_number(b, 0.0):
            return a
        if b.op == "neg":
            return self.sub(a, b.args[0])
        if a.op == "neg":
            return self.sub(b, a.args[0])
        for one, other in ((a, b), (b, a)):
            if is_number(one, 1.0) and other.op == "cos":
                return self.call("coversine", other.args[0])
            if is_number(one, -1.0):
                return self.sub(other, self.number(1.0))
        return self.call("add", a, b)

    def sub(self, a: Node, b: Node) -> Node:
        if is_number(b, 0.0):
            return a
        if is_number(a, 0.0):
            return self.neg(b)
        if b.op == "neg":
            return self.add(a, b.args[0])
        without = {"exp": "expm1", "cos": "versine", "erf": "erfc"}
        if is_number(a, 1.0) and b.op in without:
            out = self.call(without[b.op], b.args[0])
            return self.neg(out) if b.op == "exp" else out
        if is_number(b, 1.0) and a.op in without:
            out = self.call(without[a.op], a.args[0])
            return out if a.op == "exp" else self.neg(out)
        return self.call("sub", a, b)

    def neg(self, a: Node) -> Node:
        return a.args[0] if a.op == "neg" else self.call("neg", a)

    def mul(self, a: Node, b: Node) -> Node:
        for one, other in ((a, b), (b, a)):
            # a factor 0 of the calculus removes a term; one that is written does not hide a term that is not finite
            if is_number(one, 0.0) and one.origin is None:
                return one
            if is_number(one, 1.0):
                return other
            if is_number(one, -1.0):
                return self.neg(other)
            if one.op == "neg" and other.op != "number":
                return self.neg(self.mul(one.args[0], other))
        return self.call("mul", a, b)

    def div(self, a: Node, b: Node) -> Node:
        if is_number(a, 0.0) and a.origin is None:
            return a
        return a if is_number(b, 1.0) else self.neg(self.div(a.args[0], b)) if a.op == "neg" else self.call("div", a, b)

    def power(self, a: Node, b: Node) -> Node:
        if b.op != "number" or a.op == "number":
            return self.call("pow", a, b)
        n = b.value
        if n in (0.0, 1.0):
            return a if n else self.number(1.0)
        if n == 0.5:
            return self.call("sqrt", a)
        if n < 0.0 and (n == int(n) or n == -0.5) and n > -1000.0:
            return self.div(self.number(1.0), self.power(a, self.number(-n)))
        if abs(n) < 1000.0 and n == int(n):
            return self.make("ipow", (a, self.number(n)))
        return self.call("pow", a, b)

    def square(self, a: Node) -> Node:
        return self.power(a, self.number(2.0))

    def less(self, a: Node, b: Node, p: Node, q: Node) -> Node:
        return p if p is q else self.call("less", a, b, p, q)

    def select(self, c: Node, p: Node, q: Node) -> Node:
        return p if p is q else self.call("select", c, p, q)

    def side(self, a: Node) -> Node:
        """sqrt(1 - a^2)"""
        one = self.number(1.0)
        return self.call("sqrt", self.mul(self.sub(one, a), self.add(one, a)))

    def bell(self, a: Node) -> Node:
        """Derivative of the error function."""
        return self.mul(self.number(ERF), self.call("exp", self.neg(self.square(a))))

    def slope_of_power(self, node: Node, args, slopes) -> Node:
        (a, b), (da, db) = args, slopes
        if b.op == "number":
            return self.mul(self.mul(b, self.power(a, self.sub(b, self.number(1.0)))), da)
        by_base = self.number(0.0) if is_number(da, 0.0) else self.div(self.mul(b, da), a)
        return self.mul(node, self.add(self.mul(self.call("log", a), db), by_base))

    def slope(self, node: Node) -> Node:
        """Derivative of a node by the variable."""
        zero, one = self.number(0.0), self.number(1.0)
        out: dict[Node, Node] = {}
        for n in self.under(node):
            if not n.args or all(is_number(out[a], 0.0) for a in n.args):
                out[n] = one if n.op == "variable" else zero
            else:
                out[n] = OPERATIONS[n.op].slope(self, n, n.args, [out[a] for a in n.args])
        return out[node]

    def under(self, *nodes: Node) -> list[Node]:
        """Everything these nodes need, arguments first."""
        found, todo = set(), list(nodes)
        while todo:
            n = todo.pop()
            if n not in found:
                found.add(n)
                todo += n.args
        return sorted(found, key=lambda n: n.number)


def is_number(node: Node, value: float) -> bool:
    """Whether a node is that number and stays it."""
    return node.op == "number" and node.value == value and not isinstance(node.origin, str)


def zbl(g: Graph, zi: Node, zj: Node, r: Node, energy: Node, length: Node) -> Node:
    """Screened nuclear repulsion of Ziegler, Biersack and Littmark; `energy` is the Coulomb constant, `length` one Angstrom."""
    a = g.div(g.mul(g.number(0.4685), length), g.add(g.power(zi, g.number(0.23)), g.power(zj, g.number(0.23))))
    x, screening = g.div(r, a), g.number(0.0)
    for share, rate in ((0.02817, 0.20162), (0.28022, 0.4029), (0.50986, 0.94229), (0.18175, 3.1998)):
        screening = g.add(screening, g.mul(g.number(share), g.call("exp", g.mul(g.number(-rate), x))))
    return g.mul(g.div(g.mul(energy, g.mul(zi, zj)), r), screening)
