"""Interactions given as Python mappings instead of LAMMPS commands."""
from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite
from numbers import Real
from typing import TYPE_CHECKING, Any

from ase.data import chemical_symbols

from asemd.errors import InputError, nearest
from asemd.registry import find, plain_name

if TYPE_CHECKING:
    from asemd.forcefield import Interactions


def fill(interactions: Interactions, category: str, styles: Mapping[str, Any], labels: Mapping[int, str]) -> None:
    """Set styles and coefficients of one category; see `asemd.forcefield.Interactions.build`."""
    entries = []
    if not isinstance(styles, Mapping):
        raise InputError(f"{category} needs a mapping from style to coefficients, as {{'harmonic': {{1: (K, r0)}}}}, got {styles!r}")
    for title, content in styles.items():
        name, *settings = title.split()
        if isinstance(content, Mapping) and not set(content) - {"settings", "coeff"} and content:
            settings += text(content.get("settings", ()))
            content = content.get("coeff", {})
        if not isinstance(content, Mapping):
            raise InputError(f"{category} style {title}: coefficients are a mapping from type to values, as {{1: values}}, got {content!r}")
        coeff: dict = {}
        for key, values in content.items():
            place = key_of(key, category, labels)
            if place in coeff and text(values) != text(coeff[place]):
                raise InputError(f"{category} style {title}: {key!r} is there twice, with other values")
            coeff[place] = values
        entries.append((plain_name(name), settings, coeff))
    if len(entries) == 1:
        interactions.set_style(category, [entries[0][0], *entries[0][1]])
    else:
        keys = [key for _, _, coeff in entries for key in coeff]
        overlay = "/overlay" if category == "pair" and len(keys) > len(set(keys)) else ""
        interactions.set_style(category, ["hybrid" + overlay, *(w for name, settings, _ in entries for w in (name, *settings))])
    for use, (name, _, coeff) in zip(interactions.uses[category], entries, strict=False):
        for key, values in coeff.items():
            prefix = use.label.split() if interactions.hybrid[category] else []
            interactions.assign(category, [key], prefix + text(values, find(category, name)))


def key_of(key, category: str, labels: Mapping[int, str]):
    """A type, or a pair of types with the smaller one first, from numbers or labels."""
    if category != "pair":
        return number(key, category, labels)
    pair = key if isinstance(key, tuple) else (key, key)
    if len(pair) != 2:
        raise InputError(f"pair coefficients need a pair of atom types, got {key!r}")
    i, j = (number(k, "atom", labels) for k in pair)
    return (min(i, j), max(i, j))


def number(key, kind: str, labels: Mapping[int, str]) -> int:
    """The type that a number or a label means."""
    for value, label in labels.items():
        if key == label:
            return int(value)
    try:
        value = int(key)
    except (TypeError, ValueError):
        raise InputError(f"unknown {kind} type label {key!r}{nearest(str(key), labels.values())}") from None
    if value < 1 or value != key:
        raise InputError(f"{kind} types are whole numbers from 1, got {key!r}")
    return value


def text(values, style=None) -> list[str]:
    """Values as LAMMPS's words; a mapping goes by the names of the style's coefficients."""
    if isinstance(values, Mapping):
        names = [p.name for p in style.coeff] if style else list(values)
        for name in values:
            if name not in names:
                raise InputError(f"{style.category} style {style.name} has no coefficient {name!r}{nearest(name, names)}")
        names = [n for n in names if n in values]
        if style and names != [p.name for p in style.coeff][:len(names)]:
            raise InputError(f"{style.category} style {style.name}: give the coefficients in order, without gaps: "
                             f"{' '.join(p.name for p in style.coeff)}")
        values = style.format_coeff(values) if style else list(values.values())
    if isinstance(values, str):
        return values.split()
    if not hasattr(values, "__iter__"):
        values = (values,)
    return [repr(float(v)) if isinstance(v, float) else str(v) for v in values]


def coefficients(style) -> Mapping:
    """The part of a style's entry that goes by types."""
    return style.get("coeff", {}) if isinstance(style, Mapping) and style and not set(style) - {"settings", "coeff"} else style


def with_keys(styles: Mapping) -> dict:
    """Styles with keys as JSON has to write them (``"1"``, ``"Ar Kr"``) turned back into numbers and pairs."""
    def key(k):
        if not isinstance(k, str):
            return k
        words = [int(w) if w.isdigit() else w for w in k.split()]
        return words[0] if len(words) == 1 else tuple(words)
    if not isinstance(styles, Mapping):
        raise InputError(f"styles are given with their coefficients, as {{'harmonic': {{1: (13.0, 1.53)}}}}, got {styles!r}")
    out = {}
    for name, style in styles.items():
        if not isinstance(coefficients(style), Mapping):
            raise InputError(f"style {name}: coefficients are a mapping from type to values, as {{('Ar', 'Ar'): (0.01, 3.4)}}, got "
                             f"{style!r}")
        coeff = {key(k): v for k, v in coefficients(style).items()}
        out[name] = coeff if coefficients(style) is style else {**style, "coeff": coeff}
    return out


def check_numbers(skin, threads, dielectric) -> None:
    """Refuse numbers that make no sense.

    Raises
    ------
    InputError
        A skin below 0, threads that are no whole number above 0, a dielectric constant that is not positive.
    """
    for name, value, wanted, fits in (("skin", skin, "a number, not negative", lambda v: v >= 0.0),
                                      ("threads", threads, "a whole number from 1", lambda v: v >= 1 and v == int(v)),
                                      ("dielectric", dielectric, "a positive number", lambda v: v > 0.0)):
        if isinstance(value, (bool, str)) or not isinstance(value, Real) or not isfinite(value) or not fits(value):
            raise InputError(f"{name} must be {wanted}, got {value!r}")


def by_elements(error: InputError, types: list[str], pair: Mapping | None) -> InputError:
    """The message of missing coefficients with the elements that they were given by, instead of types; others as they are."""
    keys = [key if isinstance(key, tuple) else (key, key) for style in (pair or {}).values() for key in coefficients(style)]
    found = re.search(r"pair_coeff for type pairs ([\d ,]+?)(, \.\.\.)? is missing", str(error))
    if not found or not any(isinstance(word, str) for key in keys for word in key):
        return error
    missing = ["-".join(types[int(t) - 1] for t in two.split()) for two in found[1].split(", ")]
    return InputError(f"no coefficients for {', '.join(missing)}{found[2] or ''}: given are those for "
                      f"{', '.join('-'.join(map(str, key)) for key in keys)}")


def types_by_element(pair: Mapping, known: list[str], atoms) -> list[str]:
    """Elements in the order of their types: those `known` by now, then the new ones of these atoms.

    Raises
    ------
    InputError
        Coefficients go by number and there are new elements that do not come last, so that numbers would change their meaning.
    """
    keys = {k for style in pair.values() for key in coefficients(style) for k in (key if isinstance(key, tuple) else (key,))}
    named = {k for k in keys if isinstance(k, str)} if not known else set()
    for word in sorted(named - set(chemical_symbols)):
        raise InputError(f"pair coefficients: {word!r} is no chemical symbol{nearest(word, atoms.get_chemical_symbols())}")
    types = [*known, *sorted((set(atoms.get_chemical_symbols()) | named) - set(known))]
    if types != sorted(types) and any(not isinstance(k, str) for k in keys):
        raise InputError(f"coefficients are given by number, and these atoms have other elements than those before ({' '.join(known)}): "
                         f"say which type is which element, as types={sorted(types)}")
    return types


def as_json(value):
    """Values that JSON can write; pairs of types become words."""
    if isinstance(value, Mapping):
        return {" ".join(map(str, k)) if isinstance(k, tuple) else str(k): as_json(v) for k, v in value.items()}
    if hasattr(value, "tolist"):      # numbers and arrays of numpy
        return value.tolist()
    return [as_json(v) for v in value] if isinstance(value, (list, tuple)) else value
