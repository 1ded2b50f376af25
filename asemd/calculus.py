"""Derivatives of formulas by sympy, and the source that computes value, derivative and second derivative.

A formula arrives as a program, one operation a line (``mul t0 c1``), of its variable ``x`` and its constants ``c0``, ``c1``, ... What
sympy makes of a program is kept on disk, so that sympy is imported for new formulas only. The energy is first rewritten without
cancellation (``exp(x) - 1``, ``log(1 + x)``, ``1 - cos(x)``, ``1 - erf(x)``), so that its derivative keeps its digits
([decision 7](decisions/0007-expressions.md)). Conventions at jumps and kinks are those of LAMMPS: step(0) = 1, the slope of abs at 0 is 1.
"""
from __future__ import annotations

import contextlib
import hashlib
import json
import os
import tempfile
from collections.abc import Callable
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from asemd.cache_folder import cache_folder

LARGE, DEEP = 60, 9       # operations and nested functions of a formula that sympy still differentiates as a whole


class Source(NamedTuple):
    """Statements that set names from ``x`` and ``p0``, ``p1``, ..., energy and slope thereafter, and each ``p`` from ``c0``, ``c1``, ...;
    the second derivative after statements of its own."""

    lines: tuple[str, ...]
    energy: str
    slope: str
    constants: tuple[str, ...]
    bend_lines: tuple[str, ...]
    bend: str


@lru_cache(4096)
def source_of(program: tuple[str, ...]) -> Source:
    """Value and derivative of a program, from disk where it has been met before."""
    key = hashlib.sha256(Path(__file__).read_bytes() + "\n".join(program).encode()).hexdigest()
    file = cache_folder() / "expressions" / f"{key}.json"
    with contextlib.suppress(OSError, ValueError, TypeError):
        return Source(*(tuple(part) if isinstance(part, list) else part for part in json.loads(file.read_text())))
    source = differentiated(program)
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=file.parent, delete=False) as out:
            json.dump(source, out)
        os.replace(out.name, file)
    return source


def differentiated(program: tuple[str, ...]) -> Source:
    import sympy
    from sympy.codegen.cfunctions import log1p
    from sympy.codegen.rewriting import ReplaceOptim, cosm1_opt, expm1_opt, optimize

    x, functions = sympy.Symbol("x", real=True), operations()
    a, b = sympy.Wild("a"), sympy.Wild("b")
    values: list = []

    def operand(word: str):
        if word[0] == "t":
            return values[int(word[1:])]
        return x if word == "x" else sympy.Symbol(word, real=True) if word[0] == "c" else sympy.sympify(word)

    if large(program):
        return stepwise(program)
    for line in program:
        name, *words = line.split()
        values.append(functions[name](*map(operand, words)))
    near_one = ReplaceOptim(lambda e: isinstance(e, sympy.log) and e.args[0].is_Add and 1 in e.args[0].args, lambda e: log1p(e.args[0] - 1))
    complement = ReplaceOptim(a - a * sympy.erf(b), a * sympy.erfc(b))
    # not log1p_opt: it takes sums of exponentials apart into pieces that overflow
    energy = optimize(values[-1], [near_one, *[complement] * values[-1].has(sympy.erf), expm1_opt, cosm1_opt])
    constants: dict[Any, Any] = {}

    def fold(e):
        """What does not hold x becomes one constant; whole powers of a quotient become powers of its reciprocal, halves of its root."""
        if e.is_number or e is sympy.true or e == x:
            return e
        if isinstance(e, sympy.Expr) and not e.has(x):
            factor, rest = e.as_coeff_Mul()
            return factor * constants.setdefault(rest, sympy.Symbol(f"p{len(constants)}", real=True))
        if e.is_Add or e.is_Mul:
            fixed, moving = e.as_independent(x, as_Add=e.is_Add)
            if fixed.free_symbols:
                return e.func(fold(fixed), fold(moving))
        if e.is_Pow and e.exp.is_Rational and e.exp.q <= 2 and e.exp not in (-1, sympy.Rational(1, 2)):
            root = fold(e.base) if e.exp.q == 1 else sympy.sqrt(fold(e.base))
            return functions["whole"](root if e.exp > 0 else functions["recip"](root), abs(e.exp.p))
        return e.func(*map(fold, e.args))

    def written(*expressions):
        """Statements, and what the expressions are thereafter."""
        temporaries, results = sympy.cse(expressions, sympy.numbered_symbols("s"), order="none")
        write, lines = printer()
        for name, e in temporaries:
            text = write(e)
            lines.append(f"{name} = {text}")
        texts = [write(e) for e in results]
        return [[text.replace("numpy.", "np.") for text in each] for each in (lines, texts)]

    slope = sympy.diff(divided(energy, x), x)
    lines, texts = written(fold(energy), fold(slope))
    bend_lines, (bend,) = written(fold(sympy.diff(slope, x)))
    write = printer()[0]
    return Source(tuple(lines), *texts, tuple(write(e).replace("numpy.", "np.") for e in constants), tuple(bend_lines), bend)


def large(program: tuple[str, ...]) -> bool:
    """Whether sympy would take long over the formula as a whole: many operations with all definitions put in, or deeply nested ones."""
    size, depth = {}, {}
    for k, line in enumerate(program):
        name, *words = line.split()
        parts = [w for w in words if w in size]
        size[f"t{k}"] = 1 + sum(size[w] for w in parts)
        depth[f"t{k}"] = max((depth[w] for w in parts), default=0) + (name not in ("add", "sub", "neg", "mul", "same"))
    return size[f"t{len(program) - 1}"] > LARGE or max(depth.values()) > DEEP


def stepwise(program: tuple[str, ...]) -> Source:
    """Value, derivative and second derivative by the chain rule, operation by operation; the time grows with the length of the formula."""
    import sympy

    x, functions = sympy.Symbol("x", real=True), operations()
    constants: dict[Any, str] = {}
    steps: list[tuple[Any, Any, int]] = []         # a symbol, what it stands for, and which derivative of an operation it is
    values: list[tuple] = []        # value, derivative and second derivative of each operation
    moving = {x}

    def operand(word: str) -> tuple:
        if word[0] == "t":
            return values[int(word[1:])]
        if word == "x":
            return x, sympy.Integer(1), sympy.Integer(0)
        return sympy.Symbol(word, real=True) if word[0] == "c" else sympy.sympify(word), sympy.Integer(0), sympy.Integer(0)

    def named(e, order: int):
        """A symbol for the value of an expression that is not one."""
        if not (e.free_symbols & moving) or e.is_Symbol:
            return e
        symbol = sympy.Symbol(f"{'uvw'[order]}{len(steps)}", real=True)
        steps.append((symbol, e, order))
        moving.add(symbol)
        return symbol

    for line in program:
        name, *words = line.split()
        operands = [operand(w) for w in words]
        if not any(v.free_symbols & moving for v, *_ in operands):
            values.append((functions[name](*(v for v, *_ in operands)), sympy.Integer(0), sympy.Integer(0)))
            continue
        if name in ("add", "sub", "neg", "same"):
            values.append(tuple(functions[name](*parts) for parts in zip(*operands)))
            continue
        operands = [tuple(named(e, order) for order, e in enumerate(triple)) for triple in operands]
        dummies = [sympy.Dummy(real=True) for _ in operands]
        f, back = functions[name](*dummies), {d: v for d, (v, *_) in zip(dummies, operands)}
        whole, bend = functions[name](*(v for v, *_ in operands)), sympy.Integer(0)
        slope = sympy.Add(*(f.diff(d).xreplace(back) * a[1] for d, a in zip(dummies, operands)))
        for d, a in zip(dummies, operands):
            bend += f.diff(d).xreplace(back) * a[2]
            bend += sum(f.diff(d, d2).xreplace(back) * a[1] * b[1] for d2, b in zip(dummies, operands))
        values.append(tuple(named(e, order) for order, e in enumerate((whole, slope, bend))))

    def fold(e):
        """What does not hold x becomes one constant; whole powers become products."""
        if e.is_number or e in (sympy.true, sympy.false) or e in moving:
            return e
        if isinstance(e, sympy.Expr) and not e.free_symbols & moving:
            return sympy.Symbol(constants.setdefault(e, f"p{len(constants)}"), real=True)
        if e.is_Pow and e.exp.is_Integer and e.exp != -1:
            base = fold(e.base)
            return functions["whole"](base if e.exp > 0 else functions["recip"](base), abs(e.exp.p))
        return e.func(*map(fold, e.args))

    def written(highest: int, *results) -> tuple[list[str], list[str]]:
        write, lines = printer()
        for symbol, e, order in steps:
            if order <= highest:
                text = write(fold(e))
                lines.append(f"{symbol} = {text}")
        texts = [write(fold(e)) for e in results]
        return [line.replace("numpy.", "np.") for line in lines], [text.replace("numpy.", "np.") for text in texts]

    lines, (energy, slope) = written(1, *values[-1][:2])
    bend_lines, (bend,) = written(2, values[-1][2])
    write = printer()[0]
    return Source(tuple(lines), energy, slope, tuple(write(e).replace("numpy.", "np.") for e in constants), tuple(bend_lines), bend)


def divided(energy, x):
    """Quotients that level off, such as x^2 / (1 + x^2), as a constant and a remainder over the denominator; for the derivative.

    The derivative of such a quotient as it stands is a difference of nearly equal numbers where it is almost level.
    """
    import sympy

    def level(e):
        fixed, moving = e.as_independent(x, as_Add=False)
        above, below = sympy.fraction(moving)
        if not (above.has(x) and below.has(x)):
            return e
        t = sympy.Dummy("t")
        for part in (x, *sorted(moving.atoms(sympy.exp), key=str)):
            top, bottom = above.subs(part, t), below.subs(part, t)
            if not (top.has(x) or bottom.has(x)) and top.is_polynomial(t) and bottom.is_polynomial(t):
                whole, rest = sympy.div(top, bottom, t)
                return e if whole == 0 or whole.has(t) or rest.has(t) else fixed * (whole + rest / below)
        return e

    return energy.replace(lambda e: e.is_Mul and e.has(x), level)


@cache
def operations() -> dict[str, Callable]:
    """What the operations of a program are in sympy."""
    import sympy

    class tanh(sympy.Function):
        def fdiff(self, argindex=1):
            return sympy.cosh(self.args[0])**-2

    class floor(sympy.Function):
        def fdiff(self, argindex=1):
            return sympy.Integer(0)

    class ceil(floor):
        """Flat like floor."""

    class whole(sympy.Function):
        """A whole power in finished source."""

    class recip(sympy.Function):
        """A reciprocal in finished source."""

    def less(a, b, p, q):
        return sympy.Piecewise((p, a < b), (q, True))

    def zbl(zi, zj, r, energy, length):
        """Screened nuclear repulsion; `energy` is the Coulomb constant, `length` one Angstrom."""
        x = r * (zi**0.23 + zj**0.23) / (0.4685 * length)
        terms = ((0.02817, 0.20162), (0.28022, 0.4029), (0.50986, 0.94229), (0.18175, 3.1998))
        return energy * zi * zj / r * sum(share * sympy.exp(-rate * x) for share, rate in terms)

    named = {n: getattr(sympy, n) for n in "sqrt exp log sin cos tan asin acos atan atan2 sinh cosh erf erfc".split()}
    return named | {
        "same": lambda a: a, "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
        "neg": lambda a: -a, "pow": lambda a, b: a**b, "sec": lambda a: 1 / sympy.cos(a), "csc": lambda a: 1 / sympy.sin(a),
        "cot": lambda a: sympy.cos(a) / sympy.sin(a), "square": lambda a: a**2, "cube": lambda a: a**3, "tanh": tanh, "floor": floor,
        "ceil": ceil, "abs": lambda a: less(a, 0, -a, a), "step": lambda a: less(a, 0, 0, 1), "min": lambda a, b: less(a, b, a, b),
        "max": lambda a, b: less(a, b, b, a), "delta": lambda a: sympy.Piecewise((1, sympy.Eq(a, 0)), (0, True)),
        "select": lambda c, p, q: sympy.Piecewise((q, sympy.Eq(c, 0)), (p, True)), "zbl": zbl, "whole": whole, "recip": recip}


def printer() -> tuple[Callable[[Any], str], list[str]]:
    """Text of an expression in compiled source, and the list of statements that the text needs before it."""
    from sympy.printing.numpy import NumPyPrinter

    lines: list[str] = []
    products: dict[str, str] = {}

    def keep(text: str) -> str:
        if text not in products:
            products[text] = f"t{len(products)}"
            lines.append(f"{products[text]} = {text}")
        return products[text]

    def power(base: str, n: int) -> str:
        if n == 1:
            return base
        half = power(base, n // 2)
        even = keep(f"{half} * {half}")
        return keep(f"{even} * {base}") if n % 2 else even

    class Printer(NumPyPrinter):
        _kf = {**NumPyPrinter._kf, "erf": "math.erf", "erfc": "math.erfc"}

        def _print_Piecewise(self, e):
            *first, (last, _) = e.args
            return "(" + "".join(f"({self._print(p)}) if ({self._print(c)}) else " for p, c in first) + f"({self._print(last)}))"

        def _print_Relational(self, e):
            return f"({self._print(e.lhs)} {e.rel_op} {self._print(e.rhs)})"

        def _print_And(self, e):
            return f"({' and '.join(map(self._print, e.args))})"

        def _print_Or(self, e):
            return f"({' or '.join(map(self._print, e.args))})"

        def _print_Not(self, e):
            return f"(not {self._print(e.args[0])})"

        def _print_cosm1(self, e):
            return f"(-2.0*numpy.sin(0.5*({self._print(e.args[0])}))**2)"

        def _print_whole(self, e):
            base = self._print(e.args[0])
            return power(base if base.isidentifier() else keep(base), int(e.args[1]))

        def _print_recip(self, e):
            return f"(1.0/({self._print(e.args[0])}))"

        def _print_Pow(self, e, rational=False):
            return self._print_recip(e) if e.exp == -1 else super()._print_Pow(e, rational)

        def _print_Rational(self, e):
            return f"({e.p}.0/{e.q}.0)"

        def _print_Integer(self, e):
            return f"{e.p}.0"

        def _print_Float(self, e):
            return repr(float(e))

        def _print_Function(self, e):
            return f"numpy.{e.func.__name__}({', '.join(map(self._print, e.args))})"

        def _print_ImaginaryUnit(self, e):
            return "numpy.nan"      # not real, not finite: reported where it is met

        _print_ComplexInfinity = _print_ImaginaryUnit

    out = Printer({"fully_qualified_modules": True})
    return out.doprint, lines
