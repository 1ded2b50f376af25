"""Bonded styles whose energy is a formula of the user: ``*_coeff`` gives the rest value (bonds and angles) and the expression."""
from __future__ import annotations

import copy
import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from asemd.errors import InputError
from asemd.expression import ARGUMENT, VARIABLE, Compiled, compiled_function, condense, differentiate
from asemd.style import Packed, Parameter, Style, radians
from asemd.words import real

DOMAIN = "the value of its expression or of the derivative is not finite there"


class Plan(NamedTuple):
    """The function for some expressions: its source and that of the second derivative, its arguments and their values by type."""

    source: str
    bend: str
    arguments: tuple[str, ...]
    rows: dict[int, list[float]]


class Written(NamedTuple):
    """One function for several expressions: its source and that of the second derivative, its arguments after the coordinate, and the
    kinds of code it tells apart."""

    source: str
    bend: str
    arguments: tuple[str, ...]
    kinds: list[tuple]

    def values(self, compiled: Compiled) -> dict[str, float]:
        """The arguments that belong to an expression."""
        return {"kind": float(self.kinds.index(compiled.code)), **{f"p{k}": v for k, v in enumerate(compiled.constants)}}


def write(name: str, coordinate: str, argument: str, leading: list[str], compiled: Iterable[Compiled]) -> Written:
    """The function ``name(coordinate, *leading, kind, p0, p1, ...)``; `argument` is what the expressions' variable stands for."""
    compiled = list(compiled)
    kinds = list(dict.fromkeys(c.code for c in compiled))
    names = leading + ["kind"] * (len(kinds) > 1) + [f"p{k}" for k in range(max((len(c.constants) for c in compiled), default=0))]
    offset = " - offset" if "offset" in names else ""

    def text(bodies) -> str:
        lines = [f"def {name}({', '.join((coordinate, *names))}):", f"    {ARGUMENT} = {argument}"]
        for k, body in enumerate(bodies):
            other = k < len(bodies) - 1
            lines += [f"    if kind == {k}.0:"] * other + ["        " * other + "    " * (not other) + line for line in body]
        return "\n".join(lines) + "\n"

    return Written(text([(*lines, f"return {energy}{offset}, {slope}") for lines, energy, slope, *_ in kinds]),
                   text([(*lines, f"return {bend}") for *_, lines, bend in kinds]), tuple(names), kinds)


def present(text: str, text_of: Callable[[str], str]) -> tuple[str, tuple[tuple[str, float], ...]]:
    """An expression whose variables (``v_k``) have become text, and the values of those that are numbers; `text_of` gives their text."""
    given = {}
    for name in VARIABLE.findall(text):
        word = condense(text_of(name))
        try:
            given[f"v_{name}"] = real(word)
        except ValueError:
            text = re.sub(rf"(?<![A-Za-z0-9_])v_{name}\b", lambda _, word=word: word, text)
    return text, tuple(given.items())


@cache
def is_periodic(compiled: Compiled) -> bool:
    """Whether an expression of an angle has the same value one turn on."""
    pairs = [(compiled.value(x), compiled.value(x + 2.0 * math.pi)) for x in (-3.1, -2.3, -1.7, -0.9, -0.2)]
    scale = max((abs(v) for pair in pairs for v in pair if math.isfinite(v)), default=0.0)
    return all(abs(a - b) <= 1e-11 * scale for a, b in pairs)


def from_zero(compiled: Compiled) -> Compiled:
    """The same expression of an angle that runs from 0 to one turn, as LAMMPS's torsions do here."""
    turn = f"{ARGUMENT} = {ARGUMENT} + {2.0 * math.pi!r} if {ARGUMENT} < 0.0 else {ARGUMENT}"
    return replace(compiled, lines=(turn, *compiled.lines), bend_lines=(turn, *compiled.bend_lines))


class ExpressionStyle(Style):
    """``*_style lepton``: expressions of one kind (equal up to numbers) share a piece of code, others are told apart by their type.

    Parameters
    ----------
    variable : str
        The free name of the expressions: ``r``, ``theta`` or ``phi``.
    rest : str
        Name of the coefficient that is taken off the coordinate, "" for none; a style with one shifts the energy so that it is 0 there,
        unless the setting is ``no_offset``.
    """

    def __init__(self, category: str, name: str, variable: str, rest: str, **options):
        self.variable = variable
        coeff = (Parameter(rest, "angle" if category == "angle" else "distance"),) if rest else ()
        settings = (Parameter("offset", "word", True),) if rest else ()
        super().__init__(category, name, None, coeff=(*coeff, Parameter("expression", "word")), settings=settings, equilibrium=rest,
                         domain=DOMAIN, **options)
        self.coordinates = (variable,)
        example = self.bind({}, {1: self.parse_coeff(self.example.split(), {})})
        self.function, self.d2, self.arguments = example.function, example.d2, example.arguments

    def parse_settings(self, words):
        command = f"{self.category}_style {self.name}"
        if not self.equilibrium and words:
            raise InputError(f"{command} takes no words, got {' '.join(words)!r}")
        for word in words:
            if word not in ("auto_offset", "no_offset"):
                raise InputError(f"{command}: unknown word {word!r}: must be auto_offset or no_offset")
        return {"offset": words[-1]} if words else {}

    def parse_coeff(self, words, settings):
        first = len(self.coeff) - 1
        if len(words) > first and words[first][0] in "'\"":      # blanks inside the quotation marks of a data file
            words = [*words[:first], " ".join(words[first:])]
        values = super().parse_coeff(words, settings)
        values["expression"] = condense(values["expression"])
        if not VARIABLE.search(values["expression"]):
            self.compiled(values, settings)
        return values

    def fill(self, values: dict[str, Any], settings: Mapping[str, Any], text_of: Callable[[str], str]) -> None:
        """Put the present values of variables into coefficients whose expression names some; the shift is that of the first time.

        Parameters
        ----------
        text_of : callable
            Text of a variable by its name: a number, or a piece of the expression.
        """
        values["current"] = present(values["expression"], text_of)
        values["shift"] = self.compiled(values, settings)[1]

    def compiled(self, values: Mapping[str, Any], settings: Mapping[str, Any]) -> tuple[Compiled, float]:
        """The expression as source, and its value at rest, which the energy is shifted by."""
        command = f"{self.category}_coeff {self.name}"
        try:
            text, given = values.get("current", (values["expression"], ()))
            compiled = differentiate(text, self.variable, given)
        except InputError as e:
            raise InputError(f"{command}: {e.message}") from None
        if self.category == "dihedral" and not is_periodic(compiled):
            compiled = from_zero(compiled)
        if not self.equilibrium or settings.get("offset") == "no_offset":
            return compiled, 0.0
        offset = values["shift"] if "shift" in values else compiled.value(0.0)
        if not math.isfinite(offset):
            raise InputError(f"{command}: expression {values['expression']!r} is not finite at {self.variable} = 0, so its energy "
                             f"cannot be shifted to 0 there: use {self.category}_style {self.name} no_offset")
        return compiled, offset

    def plan(self, settings: Mapping[str, Any], coeffs: Mapping[int, Mapping[str, Any]]) -> Plan:
        """The function for these coefficients."""
        each = {t: self.compiled(values, settings) for t, values in sorted(coeffs.items())}
        rest, shifted = self.equilibrium, any(offset for _, offset in each.values())
        written = write(self.name, self.variable, f"np.float64({self.variable}{f' - {rest}' if rest else ''})",
                        [rest] * bool(rest) + ["offset"] * shifted, [c for c, _ in each.values()])
        rows = {}
        for t, (c, offset) in each.items():
            given = written.values(c) | {"offset": offset}
            if rest:
                given[rest] = radians(coeffs[t][rest]) if self.category == "angle" else coeffs[t][rest]
            rows[t] = [given.get(name, 0.0) for name in written.arguments]
        return Plan(written.source, written.bend, written.arguments, rows)

    def bind(self, settings, coeffs, compat=""):
        plan = self.plan(settings, coeffs)
        return bound(self, plan.source, plan.bend, plan.arguments)

    def pack(self, settings, coeffs, ntypes, units):
        plan = self.plan(settings, coeffs)
        out = np.zeros((len(plan.arguments), ntypes + 1))
        for t, row in plan.rows.items():
            out[:, t] = row
        return Packed(out)


@cache
def bound(style: ExpressionStyle, source: str, bend: str, arguments: tuple[str, ...]) -> ExpressionStyle:
    """The style with written functions; one object for each source, so that its kernels are found again."""
    twin = copy.copy(style)
    twin.function, twin.d2, twin.arguments = compiled_function(style.name, source), compiled_function(style.name, bend), arguments
    return twin


def fill_variables(uses: Iterable, text_of: Callable[[str], str]) -> list[str]:
    """Put the present values of a script's variables into all expressions; returns the names of these variables.

    Parameters
    ----------
    uses : iterable of `asemd.forcefield.Use`
    text_of : callable
        See `ExpressionStyle.fill`.
    """
    names: list[str] = []
    for use in uses:
        for values in use.coeff.values() if hasattr(use.style, "fill") else ():
            found = VARIABLE.findall(values["expression"])
            if found:
                use.style.fill(values, use.settings, text_of)
            names += found
    return names
