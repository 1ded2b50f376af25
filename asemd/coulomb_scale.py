"""Coulomb interactions times a factor of each pair of types, which ``fix adapt ... scale`` and ``compute fep`` set.

Styles that have it (`asemd.pairstyle.PairStyle.scales`) take it only when it was set: their functions get one more coefficient then.
"""
from __future__ import annotations

import copy
from dataclasses import replace
from functools import cache

from asemd.pairstyle import SCALE, PairStyle
from asemd.style import text_of


def _with_factor(function, behind: int = 0):
    """The function with a factor of the charges as its last argument but `behind` ones, and what belongs to it."""
    text = text_of(function)
    text = text[text.index("def "):]
    head, body = text.split("):\n", 1)
    first, *arguments = head.split(", ")
    arguments.insert(len(arguments) - behind, f'{SCALE}: ""')
    scope = {"__name__": function.__module__, **function.__globals__}
    source = f"{', '.join([first, *arguments])}):\n    qq = qq * {SCALE}\n{body}"
    exec(source, scope)
    new = scope[function.__name__]
    new.source = source
    return new


@cache
def factored(style: PairStyle) -> PairStyle:
    """The style whose Coulomb parts take the factor, the last one of their coefficients by pair of types."""
    twin, parts = copy.copy(style), []
    for part in style.parts:
        if part.charged:
            function = _with_factor(part.function, len(part.constants) + len(part.arrays))
            function.long = part.long
            for name, behind in (("special", 1), ("d2", 0)):
                if getattr(part.function, name, None) is not None:
                    setattr(function, name, _with_factor(getattr(part.function, name), behind + len(part.constants) + len(part.arrays)))
            part = replace(part, function=function, rows=(*part.rows, SCALE))
        parts.append(part)
    twin.parts = tuple(parts)
    return twin


def with_factors(filled: dict, factors: dict[tuple[int, int], float]) -> dict:
    """Complete coefficients by pair of types with the factors, 1 where none was set."""
    return {pair: {**c, SCALE: factors.get(pair, 1.0)} for pair, c in filled.items()}
