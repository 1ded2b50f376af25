"""Functions of formulas that take names instead of numbers: ``sum(c_ID)``, ``gmask(group)``, ``is_defined(fix,ID)`` and their relatives.

Source: the LAMMPS manual page of ``variable``. Each gets the parser, its own name and the words between the parentheses.
"""
from __future__ import annotations

import os
import platform
import re
from collections.abc import Callable

import numpy as np

from asemd.errors import InputError, Undefined
from asemd.formula_functions import REDUCE, Value


def values_of(parser, name: str, words: list[str]) -> np.ndarray:
    """The vector that ``c_ID``, ``c_ID[N]``, ``f_ID``, ``f_ID[N]`` or ``v_name`` stands for."""
    parser.arguments(name, words, 1)
    match = re.fullmatch(r"([cfv])_(\w+)(?:\[(\d+)\])?", words[0])
    if not match or (match[1] == "v" and match[3]):
        raise InputError(f"{name}() takes c_ID, c_ID[N], f_ID, f_ID[N] or v_name, got {words[0]}")
    if match[1] == "v":
        if parser.variables.find(match[2]).style != "vector":
            raise InputError(f"{name}({words[0]}): variable {match[2]} is not of style vector")
        values = parser.variables.vector(match[2])
    else:
        values = np.asarray(parser.provider.vector(match[1], match[2], int(match[3]) if match[3] else None), float)
    if not values.size:
        raise Undefined(f"{name}({words[0]}): the vector is empty")
    return values


def reduced(parser, name: str, words: list[str]) -> float:
    """``sum`` to ``slope``: one number from a vector."""
    return float(REDUCE[name](values_of(parser, name, words)))


def ordered(parser, name: str, words: list[str]) -> np.ndarray:
    """``sort`` and ``rsort``."""
    if parser.style != "vector":
        raise InputError(f"{name}() can only be used in a vector-style variable")
    values = np.sort(values_of(parser, name, words))
    return values if name == "sort" else values[::-1]


def masks(parser, name: str, words: list[str]) -> np.ndarray:
    """``gmask``, ``rmask`` and ``grmask``: 1 for atoms that belong, 0 for others."""
    parser.arguments(name, words, 2 if name == "grmask" else 1)
    if not parser.wants_atoms:
        raise InputError(f"{name}() can only be used in an atom-style variable")
    mask = parser.provider.region(words[-1]) if name != "gmask" else True
    return np.asarray(mask & parser.provider.group(words[0]) if name != "rmask" else mask, float)


def following(parser, name: str, words: list[str]) -> Value:
    """``next(x)``: the current value of a file or atomfile variable, which then takes its next one."""
    variable = parser.variables.find(parser.arguments(name, words, 1)[0])
    if variable.style == "atomfile" and parser.wants_atoms:
        values: Value = parser.variables.per_atom(words[0], parser.provider.atoms("id").size)
    elif variable.style == "file":
        values = parser.variables.leading_number(words[0])
    else:
        raise InputError(f"next({words[0]}) takes a variable of style file, or atomfile in an atom-style formula, not {variable.style}")
    parser.variables.advance([words[0]])
    return values


def asked(parser, name: str, words: list[str]) -> float:
    """``is_defined``, ``is_available`` and ``is_active`` with category and name."""
    category, word = parser.arguments(name, words, 2)
    return float(getattr(parser.provider, name.removeprefix("is_"))(category, word))


def is_file(parser, name: str, words: list[str]) -> float:
    return float(os.path.isfile(parser.arguments(name, words, 1)[0]))


def is_os(parser, name: str, words: list[str]) -> float:
    """Whether the name of the operating system matches; of the signs of regular expressions those that LAMMPS has."""
    pattern = re.sub(r"([|(){}])", r"\\\1", parser.arguments(name, words, 1)[0])
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    try:
        return float(re.search(pattern, system) is not None)
    except re.error as e:
        raise InputError(f"is_os({words[0]}): not a pattern: {e}") from None


def setting(parser, name: str, words: list[str]) -> float:
    """``extract_setting(name)``."""
    return float(parser.provider.setting(parser.arguments(name, words, 1)[0]))


def label(parser, name: str, words: list[str]) -> float:
    """``label2type(kind,label)`` and ``is_typelabel(kind,label)``."""
    kind, text = parser.arguments(name, words, 2)
    found = parser.provider.type_of(kind, text)
    if name == "is_typelabel":
        return float(found is not None)
    if found is None:
        raise InputError(f"label2type({kind},{text}): there is no {kind} type with that label")
    return float(found)


NAMED: dict[str, Callable[..., Value]] = {
    **dict.fromkeys(REDUCE, reduced), "sort": ordered, "rsort": ordered, "gmask": masks, "rmask": masks, "grmask": masks, "next": following,
    "is_defined": asked, "is_available": asked, "is_active": asked, "is_file": is_file, "is_os": is_os, "extract_setting": setting,
    "label2type": label, "is_typelabel": label}
