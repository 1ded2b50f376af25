"""A style in use, and the sub-styles that the words after ``hybrid`` name."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from asemd import words as read
from asemd.errors import InputError
from asemd.registry import exists, find, plain_name
from asemd.style import Style

HYBRID = ("hybrid", "hybrid/overlay", "hybrid/scaled", "hybrid/molecular")
ADDED = HYBRID[1:]      # a pair of types may be served by several sub-styles


@dataclass
class Use:
    """One style in use.

    Attributes
    ----------
    style : Style
    settings : dict
        Values of the ``*_style`` command.
    coeff : dict
        Type (bonded) or (i, j), i <= j (pair) -> values by name, as given; angles in degrees.
    label : str
        The style's name; in a hybrid with the same style twice with a number, ``lj/cut 1``.
    modify : dict
        What ``pair_modify pair LABEL ...`` set for this sub-style alone.
    special : dict
        ``lj``, ``coul`` -> factors of 1-2, 1-3, 1-4 pairs that ``pair_modify pair LABEL special`` set in the place of the common ones.
    scale : float or str
        Of a sub-style of ``hybrid/scaled``: a factor or a variable, ``v_name``, whose present value is `factor`; a value for each atom (n,)
        scales the forces on the atoms, and there is no energy.
    coulomb : dict
        (i, j), i <= j -> factor of the Coulomb interaction, which ``scale`` of ``fix adapt`` sets; others have 1.
    memory : dict
        What a bond style remembers from run to run: reference lengths, broken bonds.
    """

    style: Style
    settings: dict[str, Any]
    coeff: dict[Any, dict[str, Any]] = field(default_factory=dict)
    label: str = ""
    modify: dict[str, Any] = field(default_factory=dict)
    special: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    scale: float | str = 1.0
    factor: Any = field(default=1.0, repr=False, compare=False)
    coulomb: dict[tuple[int, int], float] = field(default_factory=dict, repr=False, compare=False)
    memory: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self):
        self.factor = math.nan if isinstance(self.scale, str) else self.scale


def sub_styles(category: str, hybrid: str, words: list[str]) -> list[Use]:
    """The styles that the words after ``pair_style hybrid`` and its relatives name.

    Raises
    ------
    InputError
        None, one that does not exist or cannot stand there, a missing factor, wrong settings.
    """
    command = f"{category}_style {hybrid}"
    if not words:
        raise InputError(f"{command} needs the names of its sub-styles")
    factors, groups = _scaled(words, command) if hybrid == "hybrid/scaled" else ([], _grouped(category, words))
    uses = []
    for k, (name, *rest) in enumerate(groups):
        if name in HYBRID or name == "none":
            raise InputError(f"{command} cannot have {name} as a sub-style")
        style = find(category, name)
        strange = [w for w in rest if w[0].isalpha()]
        if strange and not any(p.unit == "word" for p in style.settings):
            find(category, strange[0])        # a style that does not exist: say so, not that there are too many values
        uses.append(Use(style, style.parse_settings(rest), label=name, scale=factors[k] if factors else 1.0))
    if hybrid == "hybrid/molecular" and len(uses) != 2:
        raise InputError(f"{command} needs two sub-styles, for pairs within and between molecules, got {len(uses)}")
    names = [use.label for use in uses]
    for k, use in enumerate(uses):
        if names.count(names[k]) > 1:
            if category != "pair":
                raise InputError(f"{command} cannot use the style {names[k]} twice")
            use.label = f"{names[k]} {names[:k + 1].count(names[k])}"
    return uses


def _grouped(category: str, words: list[str]) -> list[list[str]]:
    groups: list[list[str]] = []
    for word in words:
        if not groups or exists(category, plain_name(word)):
            groups.append([plain_name(word)])
        else:
            groups[-1].append(word)
    return groups


def _scaled(words: list[str], command: str) -> tuple[list[float | str], list[list[str]]]:
    """Factors and sub-styles: a factor is the word before the name of a style."""
    def factor(word: str) -> float | str:
        return word if word.startswith("v_") else read.number(word, f"{command}: a factor stands before each sub-style, a number or v_name")

    factors = [factor(words[0])]
    if len(words) < 2:
        raise InputError(f"{command}: a sub-style must follow the factor {words[0]}")
    groups = [[plain_name(words[1])]]
    for word in words[2:]:
        if exists("pair", plain_name(word)):
            if len(groups[-1]) < 2:
                raise InputError(f"{command}: a factor, a number or a variable v_name, must stand before {word}")
            factors.append(factor(groups[-1].pop()))
            groups.append([plain_name(word)])
        else:
            groups[-1].append(word)
    return factors, groups
