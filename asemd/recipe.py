"""What makes a calculator again: its force field as LAMMPS commands, or as a dictionary that JSON can write."""
from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from asemd import units as unit_styles
from asemd.errors import InputError
from asemd.native import as_json


def commands(interactions) -> list[str]:
    """Interactions as LAMMPS commands, in their own units."""
    lines = []
    for category in interactions.uses:
        if interactions.uses[category]:
            lines.append(" ".join([f"{category}_style", *interactions.style_line(category)]))
            lines += [" ".join([f"{category}_coeff", *words]) for words in interactions.coeff_lines(category)]
    lines += [" ".join(["pair_modify", *words]) for words in interactions.modify_lines()]
    lines += [] if interactions.dielectric == 1.0 else [f"dielectric {interactions.dielectric!r}"]
    return [*lines, " ".join(["special_bonds", *interactions.special_line()]), *interactions.kspace_lines()]


def type_counts(interactions, topology) -> dict[str, int]:
    """How many types of each kind there are, by the topology and the coefficients."""
    out = {f"n{kind}types": int(types.max(initial=0)) for kind, _, types in topology}
    for category, uses in interactions.uses.items():
        name = "ntypes" if category == "pair" else f"n{category}types"
        out[name] = max([out.get(name, 0), *(k if isinstance(k, int) else max(k) for use in uses for k in use.coeff)])
    return out


def commands_of(calc) -> list[str]:
    """The commands of a calculator's interactions, after the one for two dimensions where there are two."""
    return ["dimension 2"] * (calc.like is not None and calc.like.dimension == 2) + commands(calc.interactions)


def as_dict(calc) -> dict[str, Any]:
    """The arguments of a `asemd.ForceField`; of a script's force field the commands that make it.

    Forces of fixes and exclusions by group cannot be made from words: they are named, and no calculator is made of such a dictionary.
    """
    out: dict[str, Any] = {k: as_json(v) for k, v in calc.arguments.items() if v and not (k == "dielectric" and v == 1.0)}
    rules = calc.settings.exclude
    if calc.interactions is not None and not calc.arguments:
        lines = [f"neigh_modify exclude type {i} {j}" for kind, i, *j in rules if kind == "type" for j in j]
        out |= {"units": calc.units, "commands": [*commands_of(calc), *lines], "compat": calc.interactions.compat,
                "types": calc.like.counts["ntypes"]}
    if calc.type_of:
        out["types"] = dict(calc.type_of)
    if calc.topology is not None and not calc.scripted:
        out["topology"] = {f"{kind}s": items.tolist() for kind, items, _ in calc.topology.every() if len(items)} | {
            f"{kind}_types": types.tolist() for kind, _, types in calc.topology.every() if len(types)}
    from_script = [str(load) for load in calc.loads] + [f"neigh_modify exclude {' '.join(map(str, rule))}" for rule in rules
                                                        if rule[0] != "type"]
    out |= {"from_script": from_script} if from_script else {}
    return out | {"skin": calc.settings.skin * unit_styles.factor("distance", calc.units), "precision": calc.settings.precision}


def numbers_of(types: Mapping[str, int] | Iterable[str] | int | None) -> tuple[dict[str, int], int]:
    """Element -> atom type, and the number of types, from elements in the order of their types, a mapping, or the number alone.

    Raises
    ------
    InputError
        Types that are not whole numbers from 1, an element twice.
    """
    if types is None or isinstance(types, (int, np.integer)):
        return {}, int(types or 0)
    if isinstance(types, str):
        raise InputError(f"types are elements in the order of their types, as ['O', 'H'], or a mapping, as {{'O': 1}}, got {types!r}")
    given = types if isinstance(types, Mapping) else {}
    if not given:
        symbols = list(types)
        if wrong := [s for s in symbols if not isinstance(s, str)]:
            raise InputError(f"types are elements in the order of their types, as ['O', 'H'], or their number, got {wrong[0]!r}")
        if len(set(symbols)) < len(symbols):
            twice = next(s for s in symbols if symbols.count(s) > 1)
            raise InputError(f"types has {twice} twice: atoms of one element that differ in their type need the array 'type'")
        given = {symbol: k for k, symbol in enumerate(symbols, 1)}
    wrong = [(s, k) for s, k in given.items() if isinstance(k, bool) or not isinstance(k, (int, np.integer)) or k < 1]
    if wrong:
        raise InputError(f"types: atom types are whole numbers from 1, got {wrong[0][1]!r} for {wrong[0][0]}")
    return {s: int(k) for s, k in given.items()}, max(map(int, given.values()), default=0)


def take_commands(calc, lines: str | Iterable[str], units: str, ntypes: int, compat: str) -> None:
    """Give a calculator the force field of LAMMPS commands.

    Raises
    ------
    InputError
        See `asemd.lammps.interactions.scene_of`; no units.
    """
    if not units:
        raise InputError("commands need units=, the LAMMPS unit style of their numbers, as units='metal'")
    text = lines if isinstance(lines, str) else "\n".join(lines)
    scene = importlib.import_module("asemd.lammps.interactions").scene_of(text, units, ntypes, compat)      # of a higher floor
    calc.arguments, calc.interactions, calc.units, calc.like = {}, scene.interactions, units, scene.system
    calc.settings = replace(calc.settings, skin=calc.settings.skin / unit_styles.factor("distance", units), exclude=scene.neighbor.exclude)
