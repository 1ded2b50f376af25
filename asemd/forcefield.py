"""Interactions: which styles act with which coefficients, as plain data in the units of the scene."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asemd import kspace_settings, modifiers
from asemd import units as unit_styles
from asemd import words as read
from asemd.errors import InputError, nearest
from asemd.pairing import PairTerm, check_complete, make_terms, reach
from asemd.registry import find, plain_name
from asemd.topology import ATOMS
from asemd.uses import ADDED, HYBRID, Use, sub_styles

CATEGORIES = (*ATOMS, "pair")


def _property(category: str) -> property:
    def get(self):
        uses = self.uses[category]
        return uses if len(uses) > 1 else uses[0] if uses else None
    return property(get, doc=f"The `Use` of the {category} style, a list of them for several, None without one.")


@dataclass
class Interactions:
    """The force field of a scene.

    Attributes
    ----------
    uses : dict
        bond, angle, dihedral, improper, pair -> list of `Use`; empty: no such interactions.
    hybrid : dict
        Category -> ``""``, ``"hybrid"``, or for pairs ``"hybrid/overlay"``, ``"hybrid/scaled"``, ``"hybrid/molecular"``.
    none : dict
        Category -> types (or pairs of types) of a hybrid set to ``none``.
    special_lj, special_coul : (float, float, float)
        Factors of 1-2, 1-3 and 1-4 pairs.
    special_angle, special_dihedral : bool
        1-3 (1-4) pairs are special only if they are the ends of an angle (dihedral).
    shift, tail : bool
    mix : str or None
        Rule of ``pair_modify mix``; None: each style's own.
    compute : bool
        False: ``pair_modify compute no``.
    table : dict
        ``pair_modify table tabinner table/disp tabinner/disp``, for styles with a long-range part.
    compat : str
        ``"lammps"``: LAMMPS's forces also where they are not minus the gradient of its energy, and its tables of what a long-range
        solver leaves where none are asked for.
    dielectric : float
    kspace : str
        Words of ``kspace_style``.
    kspace_modify : dict
        Keyword -> value of `asemd.kspace_settings`, those that were given since the style was chosen.
    kspace_factor : float
        Of the Coulomb part of the solver; ``fix adapt`` changes it for the time of a run.
    long_range : dict
        What pair styles must know of the solver, such as ``g_ewald``; `asemd.kspace.solve` sets it before forces are computed.
    """

    uses: dict[str, list[Use]] = field(default_factory=lambda: {c: [] for c in CATEGORIES})
    hybrid: dict[str, str] = field(default_factory=lambda: dict.fromkeys(CATEGORIES, ""))
    none: dict[str, set] = field(default_factory=lambda: {c: set() for c in CATEGORIES})
    special_lj: tuple[float, float, float] = (0.0, 0.0, 0.0)
    special_coul: tuple[float, float, float] = (0.0, 0.0, 0.0)
    special_angle: bool = False
    special_dihedral: bool = False
    shift: bool = False
    tail: bool = False
    mix: str | None = None
    compute: bool = True
    table: dict[str, float] = field(default_factory=dict)
    compat: str = ""
    dielectric: float = 1.0
    kspace: str = "none"
    kspace_modify: dict[str, Any] = field(default_factory=dict)
    kspace_factor: float = field(default=1.0, compare=False)
    long_range: dict[str, float] = field(default_factory=dict, compare=False)

    bond, angle, dihedral, improper, pair = map(_property, CATEGORIES)

    @property
    def needs_solver(self) -> bool:
        """Whether a pair style leaves a part to a long-range solver."""
        return any(use.style.needs(use.settings) for use in self.uses["pair"])

    @property
    def is_oriented(self) -> bool:
        """Whether a pair style turns atoms."""
        return any(use.style.variant(use.settings).oriented for use in self.uses["pair"])

    def coulomb_constant(self, units) -> float:
        """The energy of two unit charges at unit distance for dielectric constant 1; some styles ask for CHARMM's number."""
        charmm = any(use.style.charmm_constant for use in self.uses["pair"]) and units == unit_styles.get("real")
        return 332.0716 if charmm else units.qqr2e

    def style_name(self, category: str) -> str:
        """The name after ``*_style``: ``none``, a style or a hybrid."""
        return self.hybrid[category] or (self.uses[category][0].style.name if self.uses[category] else "none")

    # ------------------------------------------------------------------ styles and coefficients ---

    def set_style(self, category: str, words: list[str]) -> None:
        """``bond_style WORDS`` and its relatives.

        The same pair style again keeps its coefficients and takes the new settings; everything else starts afresh.
        """
        command = f"{category}_style"
        if not words:
            raise InputError(f"{command} needs the name of a style")
        name, rest = plain_name(words[0]), list(words[1:])
        if name == "none":
            if rest:
                raise InputError(f"{command} none takes no arguments, got {' '.join(rest)}")
            uses: list[Use] = []
        elif name in HYBRID:
            if name != "hybrid" and category != "pair":
                raise InputError(f"unknown {category} style {name!r} (did you mean hybrid?)")
            uses = sub_styles(category, name, rest)
        else:
            style = find(category, name)
            uses = [Use(style, style.parse_settings(rest), label=name)]
            old = self.uses[category]
            if category == "pair" and not self.hybrid[category] and old and old[0].style is style:
                uses[0].coeff, uses[0].coulomb = style.reset_cutoffs(old[0].coeff), old[0].coulomb
                self.uses[category] = uses
                return
        self.uses[category], self.none[category] = uses, set()
        self.hybrid[category] = name if name in HYBRID else ""
        if category == "pair":
            self.shift, self.tail, self.mix, self.compute, self.table = False, False, None, True, {}

    def set_coeff(self, category: str, words: list[str], system) -> None:
        """``bond_coeff WORDS`` and its relatives.

        Raises
        ------
        InputError
            No style yet, a type out of range, a wrong number of values, a value that makes no sense.
        """
        command = f"{category}_coeff"
        if not self.uses[category]:
            raise InputError(f"{command} command before {category}_style is defined")
        width = 2 if category == "pair" else 1
        if len(words) < width:
            raise InputError(f"{command} needs {'two atom types' if width == 2 else f'a {category} type'} and coefficients")
        kind = "atom" if category == "pair" else category
        n = system.counts["ntypes" if category == "pair" else f"n{category}types"]
        if n < 1:
            raise InputError(f"{command}: there are no {kind} types")
        ranges = [read.bounds(w, 1, n, f"{command}: {kind} type", system.labels.get(kind)) for w in words[:width]]
        self.assign(category, type_keys(ranges, command), list(words[width:]))

    def assign(self, category: str, keys: Iterable, words: list[str]) -> None:
        """Give coefficients to types or pairs of types (i <= j); in a hybrid `words` begin with the sub-style."""
        uses, keys = self.uses[category], list(keys)
        use, command = uses[0], f"{category}_coeff"
        if self.hybrid[category]:
            if not words:
                raise InputError(f"{command}: {category}_style {self.hybrid[category]} needs the name of a sub-style after the types")
            name = plain_name(words[0])
            if name == "none":
                if len(words) > 1:
                    raise InputError(f"{command}: none takes no coefficients, got {' '.join(words[1:])}")
                for key in keys:
                    self._forget(category, key)
                    self.none[category].add(key)
                return
            if name == "skip" and category in ("angle", "dihedral", "improper"):
                return
            use, words = self.sub_style(category, name, words[1:])
        values = use.style.parse_coeff(words, use.settings)
        for key in use.style.keys(values, keys):
            joined = use.style.join(use.coeff.get(key, {}), values)
            if self.hybrid[category] not in ADDED:
                self._forget(category, key)
            self.none[category].discard(key)
            use.coeff[key] = joined
            use.coulomb.pop(key, None)

    def sub_style(self, category: str, name: str, words: list[str]) -> tuple[Use, list[str]]:
        """The sub-style named in a coefficient line, and the words after its name (and number)."""
        command, same = f"{category}_coeff", [u for u in self.uses[category] if u.style.name == name]
        if not same:
            known = [u.style.name for u in self.uses[category]]
            raise InputError(f"{command}: expected a sub-style of {category}_style {self.hybrid[category]}, one of {' '.join(known)}, "
                             f"got {name!r}{nearest(name, known)}")
        if len(same) == 1:
            return same[0], words
        if not words or words[0] not in map(str, range(1, len(same) + 1)):
            raise InputError(f"{command}: {name} is listed {len(same)} times, its name must be followed by a number from 1 to {len(same)}")
        return same[int(words[0]) - 1], words[1:]

    def _forget(self, category: str, key) -> None:
        for use in self.uses[category]:
            use.coeff.pop(key, None)

    # ------------------------------------------------------------------------------ modifiers ---

    def modify_pair(self, words: list[str]) -> None:
        """``pair_modify WORDS``."""
        modifiers.modify_pair(self, words)

    def modified(self, use: Use, keyword: str):
        """``shift``, ``tail``, ``mix`` or ``compute`` as it holds for one sub-style."""
        return use.modify.get(keyword, getattr(self, keyword))

    def set_special(self, words: list[str]) -> None:
        """``special_bonds WORDS``; what is not said goes back to its default."""
        modifiers.set_special(self, words)

    def special_pairs(self, system) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of rows (m, 2) and kinds (m,) in 1, 2, 3 that the special factors act on."""
        return system.topology.special(system.n, self.special_angle, self.special_dihedral)

    # ------------------------------------------------------------------------------- for engines ---

    def rest_values(self, category: str, ntypes: int) -> np.ndarray:
        """Rest lengths of bond types or rest angles (degrees) of angle types, as constraints take them.

        Returns
        -------
        (ntypes + 1,) float
            By type, entry 0 unused; nan where a type has no coefficients or its style no rest value.
        """
        out = np.full(ntypes + 1, np.nan)
        for use in self.uses[category]:
            for t, coeff in use.coeff.items():
                out[t] = use.style.rest_value(coeff)
        return out

    def learn(self, system) -> None:
        """Tell the pair styles what they must know of the atoms, see `asemd.pairstyle.PairStyle.learn`."""
        for use in self.uses["pair"]:
            use.style.learn(use.settings, system)

    def pair_terms(self, ntypes: int, units) -> list[PairTerm]:
        """The pair styles with the coefficients of all type pairs, mixed and shifted.

        Raises
        ------
        InputError
            A pair of types has no coefficients.
        """
        return make_terms(self, ntypes, units)

    def tail_correction(self, system, units, types: range | None = None) -> tuple[float, float]:
        """Energy and pressure of ``pair_modify tail yes``, in units of the scene; with `types` of the pairs with an atom of these.

        As in LAMMPS also of styles with ``pair_modify compute no``.
        """
        parts = [term.tail(system, units, types) for term in make_terms(self, system.counts["ntypes"], units, idle=True)]
        return sum(e for e, _ in parts), sum(p for _, p in parts)

    def cutoff(self, ntypes: int, units) -> float:
        """The largest distance at which a pair style wants to know about pairs."""
        return reach(self, ntypes)

    def check_complete(self, system) -> None:
        """See `asemd.pairing.check_complete`."""
        check_complete(self, system)

    # ------------------------------------------------------------------------------- written back ---

    def style_line(self, category: str) -> list[str]:
        """Words after ``*_style`` that make the styles again."""
        out = [self.hybrid[category]] if self.hybrid[category] else []
        for use in self.uses[category]:
            out += [str(use.scale)] if self.hybrid[category] == "hybrid/scaled" else []
            out += [use.style.name, *use.style.format_settings(use.settings)]
        return out or ["none"]

    def coeff_lines(self, category: str) -> list[list[str]]:
        """Words after ``*_coeff`` of all lines that make the coefficients again, sorted by type."""
        lines = [(key, -1, [*_words_of(key), "none"]) for key in self.none[category]]
        for k, use in enumerate(self.uses[category]):
            name = use.label.split() if self.hybrid[category] else []
            lines += [(key, k, [*types, *name, *line]) for key, types, line in use.style.lines(use.coeff)]
        return [line for _, _, line in sorted(lines, key=lambda entry: entry[:2])]

    def modify_lines(self) -> list[list[str]]:
        """Words after ``pair_modify`` of all lines that make its settings again."""
        if not self.uses["pair"]:
            return []
        out = [["shift", _yes(self.shift), "tail", _yes(self.tail), "compute", _yes(self.compute)]]
        out[0] += ["mix", self.mix] if self.mix else []
        for name, value in self.table.items():
            out[0] += [name, repr(value)]
        for use in sorted(self.uses["pair"], key=lambda use: use.modify.get("tail", self.tail) == self.tail):     # the last one decides
            words = [w for name, three in use.special.items() for w in ("special", name, *map(repr, three))]
            words += [w for k, v in use.modify.items() for w in (k, v if k == "mix" else _yes(v))]
            if words:
                out.append(["pair", *use.label.split(), *words])
        return out

    def special_line(self) -> list[str]:
        """Words after ``special_bonds``."""
        return ["lj", *map(repr, self.special_lj), "coul", *map(repr, self.special_coul),
                "angle", _yes(self.special_angle), "dihedral", _yes(self.special_dihedral)]

    def kspace_lines(self) -> list[str]:
        """Commands that make the long-range solver again."""
        out = [f"kspace_style {self.kspace}"] if self.kspace != "none" else []
        words = kspace_settings.to_words(self.kspace_modify)
        return [*out, f"kspace_modify {' '.join(words)}"] if words else out

    @classmethod
    def build(cls, *, bond=None, angle=None, dihedral=None, improper=None, pair=None,
              special_bonds: str | Mapping[str, Any] | Sequence[float] = "", dielectric: float = 1.0, shift: bool = False,
              tail: bool = False, mix: str | None = None,
              labels: Mapping[str, Mapping[int, str]] | None = None, compat: str = "", kspace: str = "",
              kspace_modify: str = "") -> Interactions:
        """Interactions from Python, in the units of the scene (ASE's for a scene without a script), angles in degrees.

        Parameters
        ----------
        bond, angle, dihedral, improper : mapping, optional
            Style -> {type: values}, as ``{"harmonic": {1: (K, r0)}}``; values are a number, a sequence in the order of the style's
            coefficients, a mapping by name, or LAMMPS's words as a string. Several styles make a hybrid.
        pair : mapping, optional
            Style, settings included, -> {(type, type): values}, as ``{"lj/cut 10.0": {(1, 1): (0.01, 3.4)}}``, or style ->
            ``{"settings": (10.0,), "coeff": {...}}``. Several styles make a hybrid, an overlay if they share type pairs.
        special_bonds : str or mapping, optional
            Words of the command (``"amber"``), factors ``{"lj": (0, 0, 0.5), "coul": (0, 0, 0.8)}``, or three factors for both.
        dielectric, shift, tail, mix, compat
            As the attributes.
        kspace, kspace_modify : str
            Words of the commands: ``kspace="pppm 1.0e-4"``, ``kspace_modify="order 6"``.
        labels : mapping, optional
            kind (atom bond angle dihedral improper) -> {type: label}; labels may then stand for types.

        Raises
        ------
        InputError
            An unknown style, a wrong number of values, an unknown label.
        """
        from asemd.native import fill
        out = cls(dielectric=dielectric, compat=compat, kspace=" ".join(kspace.split()) or "none",
                  kspace_modify=kspace_settings.parse(kspace_modify.split()))
        given = {"bond": bond, "angle": angle, "dihedral": dihedral, "improper": improper, "pair": pair}
        for category, styles in given.items():
            if styles:
                fill(out, category, styles, (labels or {}).get("atom" if category == "pair" else category, {}))
        out.shift, out.tail = bool(shift), bool(tail)
        out.mix = None if mix is None else read.choice(mix, modifiers.MIX_RULES, "mix")
        if special_bonds:
            if not isinstance(special_bonds, (str, Mapping)):
                special_bonds = {"lj/coul": tuple(special_bonds)}
            named = special_bonds.split() if isinstance(special_bonds, str) else [
                str(w) for k, v in special_bonds.items() for w in (k, *(v if isinstance(v, (tuple, list)) else [_yes(v)]))]
            out.set_special(named)
        return out


def type_keys(ranges: list[tuple[int, int]], command: str) -> list:
    """Types of one range, or pairs (i, j), i <= j, of two; two single types may come in either order."""
    (a, b), *rest = ranges
    if not rest:
        return list(range(a, b + 1))
    c, d = rest[0]
    if a == b and c == d:
        return [(min(a, c), max(a, c))]
    keys = [(i, j) for i in range(a, b + 1) for j in range(max(i, c), d + 1)]
    if not keys:
        raise InputError(f"{command}: no pair of types i <= j in these ranges")
    return keys


def _words_of(key) -> list[str]:
    return [str(k) for k in key] if isinstance(key, tuple) else [str(key)]


def _yes(value: bool) -> str:
    return "yes" if value else "no"
