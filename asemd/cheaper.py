"""Twins of the formulas of pair styles that cost less in kernels over clusters of atoms.

Two attributes of a formula name some, each a mapping from the precision (True: single) to pairs of a twin and a function that makes its
numbers, or None where they will not do. The first pair that has numbers is taken.

- ``series``: the twin takes other constants, made of the formula's own constants and the cutoff.
- ``powers``: the twin takes other coefficients of the pairs of types, made of the formula's own ones. They are the twin's arguments behind
  the first.
"""
from __future__ import annotations

import copy
import inspect
import math
from dataclasses import replace
from functools import cache

import numpy as np

from asemd.pairstyle import PairStyle, PairTables, Part, make_part


def cheaper(style: PairStyle, tables: PairTables, uniform: tuple[bool, ...],
            single: bool = False) -> tuple[PairStyle, PairTables, tuple[bool, ...]]:
    """A style for kernels over clusters, its tables, and which rows hold one value for all pairs of types, of those of `style`.

    What follows the constants of the parts stays at the end.
    """
    parts, numbers, rows, same, at, row = [], [], tables.rows.copy(), list(uniform), 0, 0
    for part in style.parts:
        end = row + 2 + len(part.rows)
        own = list(tables.constants[at:at + len(part.constants)])
        at += len(part.constants)
        twin, values = _first(part, "series", single, *own, math.sqrt(float(rows[row].max())))
        if twin:
            own, part = values, replace(make_part(twin, part.cut, set(part.rows)), long=part.long)
        twin, values = _first(part, "powers", single, *rows[row + 2:end])
        if twin:
            rows[row + 2:end] = values
            same[row + 2:end] = [all(same[row + 2:end])] * len(part.rows)
            part = make_part(twin, part.cut, set(inspect.getfullargspec(twin).args[1:len(part.rows) + 1]))
        parts.append(part)
        numbers += own
        row = end
    return _of_parts(style, tuple(parts)), replace(tables, rows=rows, constants=np.array([*numbers, *tables.constants[at:]])), tuple(same)


def _first(part: Part, attribute: str, single: bool, *numbers) -> tuple:
    for twin, make in getattr(part.function, attribute, {}).get(single, ()):
        values = make(*numbers)
        if values is not None:
            return twin, values
    return None, None


@cache
def _of_parts(style: PairStyle, parts: tuple[Part, ...]) -> PairStyle:
    if parts == style.parts:
        return style
    out = copy.copy(style)
    out.parts = parts
    return out
