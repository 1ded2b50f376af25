r"""Pair styles: functions of the distance, and the axes around them (cutoff, shift, mixing, special factors).

A pair style is a sum of parts, each a function of ``r2`` (or ``r``) that returns energy and derivative by that argument::

    @pair("lj/cut", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, example=...)
    def lj_cut(r2, epsilon: "energy", sigma: "distance"): ...

A part that takes ``qq`` (the product of charges times the Coulomb constant) is a Coulomb part: it follows the Coulomb special
factors and is counted as ``ecoul``. Cutoff, shift, mixing, special factors are axes around the function, never inside it.

Annotations and bodies follow the rules of `asemd.style`.
"""
from __future__ import annotations

import inspect
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.style import Parameter, Style, register, units_of

SCALE = "coulomb_scale"      # a row of Coulomb parts, see `asemd.coulomb_scale`


@dataclass(frozen=True)
class Part:
    """One function of a pair style: `kind` vdwl or coul says which special factor and which thermo column it has;
    `cut` is the name of the coefficient or setting that ends it."""

    function: Callable
    kind: str
    cut: str
    rows: tuple[str, ...]        # per-pair coefficients it takes, in order
    constants: tuple[str, ...]   # settings it takes, in order
    arrays: tuple[str, ...]
    coordinate: str              # "r" or "r2"
    charged: bool
    sized: bool = False          # it takes radius_i and radius_j, the radii of both atoms
    long: bool = False           # the weight of a special pair is that of its bare energy: a solver adds the rest of all pairs


@dataclass(frozen=True)
class PairTables:
    """`rows (nrow, ntypes+1, ntypes+1)`: for each part cut^2, offset, then its coefficients; `constants`: settings of all parts."""

    rows: np.ndarray
    constants: np.ndarray
    arrays: tuple[np.ndarray, ...] = ()


def mix_energy(rule: str, ei: float, ej: float, si: float, sj: float) -> float:
    """Energy of a mixed pair; `si, sj` are the sizes that the rule ``sixthpower`` weighs with."""
    if ei * ej < 0.0:
        raise InputError(f"energies {ei:g} and {ej:g} of different sign cannot be mixed: give pair_coeff for that pair of types")
    energy = math.sqrt(ei * ej)
    if rule == "sixthpower":
        a, b = abs(si) ** 3, abs(sj) ** 3
        return 2.0 * energy * a * b / (a * a + b * b) if a + b > 0.0 else 0.0
    return energy


def mix_distance(rule: str, si: float, sj: float) -> float:
    """Length of a mixed pair."""
    if rule == "geometric":
        if si * sj < 0.0:
            raise InputError(f"lengths {si:g} and {sj:g} of different sign cannot be mixed: give pair_coeff for that pair of types")
        return math.sqrt(si * sj)
    if rule == "arithmetic":
        return 0.5 * (si + sj)
    return ((si**6 + sj**6) / 2.0) ** (1.0 / 6.0)


def _names(spec: str) -> list[tuple[str, bool]]:
    """``"epsilon sigma [cut]"`` -> [(epsilon, False), (sigma, False), (cut, True)]."""
    return [(w.strip("[]"), w.startswith("[")) for w in spec.split()]


class PairStyle(Style):
    """A pair style: a fused sum of parts on a grid of type pairs.

    Parameters
    ----------
    parts : sequence of (function, cut)
        Functions and the name of the setting or coefficient that is their cutoff.
    settings, coeff : str
        ``"cut_lj [cut_coul]"``: names of the words, optional ones in brackets; an optional coefficient defaults to the setting of the
        same name or follows the coefficient named in `defaults`, an optional setting to `defaults`.
    mix : mapping
        Coefficient -> how i-j follows from i-i and j-j: ``distance``; for an energy the coefficient that plays sigma in the rule
        ``sixthpower``, or ``geometric`` or ``arithmetic`` whatever the rule. Cutoffs mix as distances. Empty: i-j must be given.
        `mix_rule` is the default rule.
    tail : callable, optional
        ``tail(coeff, cut) -> (e, p)``: integrals for ``pair_modify tail yes`` of one type pair (energy and pressure, without the
        factors of number and volume), see `asemd/pair/lj_cut.py`.
    units : mapping
        Units of settings and coefficients that no function argument names.
    splits : bool
        The force may be split by distance between the levels of ``run_style respa``, as LAMMPS allows for this style.
    rows : str
        Names of function arguments that differ by pair of types but are not words of ``pair_coeff``.
    derived : callable, optional
        ``derived(coeff, settings)``: mapping of these names to their values for one pair of types; without it `pack_pairs` makes them.
    shifts : bool
        ``pair_modify shift yes`` has an effect.
    scales : bool
        Coulomb parts can have a factor for each pair of types, ``scale`` of ``fix adapt``.
    """

    solvers: frozenset[str] = frozenset()      # kinds of kspace_style that complete the parts; empty: none is needed
    many = False                     # energies of single pairs; True: `asemd.manybody`
    twin: PairStyle | None = None    # gives LAMMPS's numbers where LAMMPS's force is not minus the gradient of its energy
    stirred = False                  # forces depend on velocities and random numbers, see `asemd.noise_term`
    dielectric = False               # each charge stands in a medium of its own, see `asemd.dielectric_term`
    oriented = ""                    # what the atoms have that torques turn, see `asemd.oriented_term`
    all_or_nothing = False           # special pairs whose weight is not 0 count in full
    unweighted: PairStyle | None = None      # special pairs are added up without weights; those of single pairs are this style's
    charmm_constant = False          # in units real the Coulomb constant is that of CHARMM
    molecules = ""                   # same or other: only pairs of atoms of one molecule, or of two
    extra = 0                        # numbers that compute pair gives beside the energy
    restarts = True                  # restart files keep settings, and coefficients unless they are numbers of a file
    from_files = False
    takes_tables = True              # ``pair_modify table`` has an effect, as in LAMMPS
    tables: dict[Callable, Callable] = {}       # functions looked up in a table by others than their own ``table``
    special_only = False             # pairs that are not special do not interact
    needs_newton = False             # newton off is refused, as by LAMMPS
    on_sites = False                 # it acts on charges that are not on atoms, see `asemd.charge_sites`

    def __init__(self, name: str, parts, *, settings="", coeff="", defaults=MappingProxyType({}), mix=MappingProxyType({}),
                 mix_rule="geometric", tail=None, units=MappingProxyType({}), rows="", splits=False, derived=None,
                 shifts=True, scales=False, **options):
        notes = dict(units)
        for function, _ in parts:
            notes = {**units_of(function), **notes}
        self.mix, self.mix_rule, self.tail, self.splits = dict(mix), mix_rule, tail, splits
        self.derived, self.shifts, self.scales = derived, shifts, scales

        def parameters(spec):
            return tuple(Parameter(n, notes.get(n) or ("distance" if n.startswith(("cut", "inner", "outer")) else ""), optional,
                                   defaults.get(n)) for n, optional in _names(spec))
        main = parts[0][0] if parts else None
        super().__init__("pair", name, main, settings=parameters(settings), coeff=parameters(coeff), **options)
        mine = {p.name for p in self.coeff} | set(rows.split())
        self.parts = tuple(make_part(function, cut, mine) for function, cut in parts)
        self.charged, self.sized = any(p.charged for p in self.parts), any(p.sized for p in self.parts)
        self.solvers = frozenset().union(*(getattr(f, "solvers", ()) for f, _ in parts))
        if self.solvers:
            self.xfail.setdefault("gradient", "LAMMPS's erfc is good to 1.5e-7, and its force is that of the exact function")

    def learn(self, settings: dict[str, Any], system) -> None:
        """Keep in `settings` what the style must know of the atoms before its coefficients become tables.

        Raises
        ------
        InputError
            The atoms lack what the style needs; the message says what.
        """
        if self.sized:
            if "radius" not in system.extra:
                raise InputError(f"pair style {self.name} needs atom attribute radius: use atom_style sphere")
            settings["radii"] = largest_radii(system)

    @property
    def listed(self) -> bool:
        """Whether it works on plain lists of pairs only."""
        return self.sized

    def needs(self, settings: Mapping[str, Any]) -> frozenset[str]:
        """Kinds of kspace_style that complete the style with these settings; empty: none is needed."""
        return self.solvers

    def functions(self):
        return tuple(p.function for p in self.parts)

    def works_with(self, settings: Mapping[str, Any]) -> frozenset[str]:
        """Kinds of kspace_style that may stand beside it: by default those that it needs."""
        return self.needs(settings)

    def variant(self, settings: Mapping[str, Any], compat: str = "") -> PairStyle:
        """The style whose parts are computed: this one, unless settings or ``compat="lammps"`` ask for other functions."""
        return self.twin if compat == "lammps" and self.twin else self

    def pieces(self) -> Sequence[PairStyle]:
        """What it is computed as, in turn: this style, unless some of its parts act elsewhere."""
        return (self,)

    def parse_settings(self, words):
        values = super().parse_settings(words)
        for p in self.settings:
            if p.name not in values and p.default is not None:
                values[p.name] = values[p.default] if isinstance(p.default, str) else p.default
            if p.name.startswith("cut") and values.get(p.name, 1.0) < 0.0:
                raise InputError(f"pair_style {self.name}: cutoff {p.name} must not be negative, got {values[p.name]:g}")
        return values

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        for p in self.coeff:
            if p.name.startswith("cut") and values.get(p.name, 1.0) < 0.0:
                raise InputError(f"pair_coeff {self.name}: cutoff {p.name} must not be negative, got {values[p.name]:g}")
        return values

    def reset_cutoffs(self, coeffs: Mapping[tuple[int, int], Mapping[str, Any]]) -> dict[tuple[int, int], dict[str, Any]]:
        """Coefficients after the same ``pair_style`` is given again: cutoffs of single pairs go back to the setting."""
        return {pair: {n: v for n, v in values.items() if not n.startswith("cut")} for pair, values in coeffs.items()}

    def cutoffs(self, coeff: Mapping[str, Any], settings: Mapping[str, Any]) -> list[float]:
        """Cutoff of each part for one pair of types."""
        return [float(coeff.get(p.cut, settings.get(p.cut, 0.0))) for p in self.parts]

    def reach(self, coeff: Mapping[str, Any], settings: Mapping[str, Any]) -> float:
        """The distance up to which the neighbour list must go for one pair of types."""
        return max(self.cutoffs(coeff, settings), default=0.0)

    def complete(self, values: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
        """Coefficients of one pair with the optional ones filled in: those given, else the one it follows, else the setting."""
        out = dict(values)
        for p in self.coeff:
            if p.name not in out:
                if isinstance(p.default, str) and p.default in values:
                    out[p.name] = values[p.default]
                elif p.name in settings:
                    out[p.name] = settings[p.name]
        return out

    def mixed(self, a: Mapping[str, Any], b: Mapping[str, Any], rule: str) -> dict[str, Any]:
        """Coefficients of i-j from the complete ones of i-i and j-j."""
        out = {}
        for p in self.coeff:
            how = self.mix.get(p.name) or ("distance" if p.name.startswith("cut") else "")
            if how == "distance":
                out[p.name] = mix_distance(rule, a[p.name], b[p.name])
            elif how == "arithmetic":
                out[p.name] = 0.5 * (a[p.name] + b[p.name])
            elif how == "geometric":
                out[p.name] = mix_energy(how, a[p.name], b[p.name], 0.0, 0.0)
            elif how:
                out[p.name] = mix_energy(rule, a[p.name], b[p.name], a[how], b[how])
        return out

    def filled(self, coeffs: Mapping[tuple[int, int], Mapping[str, Any]], settings: Mapping[str, Any], ntypes: int,
               rule: str | None = None, only=None) -> dict[tuple[int, int], dict[str, Any]]:
        """Coefficients of every pair i <= j: given ones, else mixed ones.

        Parameters
        ----------
        rule : str, optional
            ``geometric``, ``arithmetic`` or ``sixthpower`` of pair_modify; None is the style's own.
        only : set of (i, j), optional
            The pairs this sub-style of a hybrid serves; None: all.

        Raises
        ------
        InputError
            A pair is neither given nor mixable.
        """
        pairs = only if only is not None else {(i, j) for i in range(1, ntypes + 1) for j in range(i, ntypes + 1)}
        out, missing = {}, []
        for i, j in sorted(pairs):
            if (i, j) in coeffs:
                out[i, j] = self.complete(coeffs[i, j], settings)
            elif i != j and (self.mix or not self.coeff) and (i, i) in coeffs and (j, j) in coeffs:
                a, b = self.complete(coeffs[i, i], settings), self.complete(coeffs[j, j], settings)
                try:
                    out[i, j] = self.mixed(a, b, rule or self.mix_rule)
                except InputError as e:
                    raise InputError(f"pair style {self.name}, types {i} {j}: {e.message}") from None
            else:
                missing.append((i, j))
        if missing:
            raise InputError(missing_pairs(missing) + ("" if self.mix or not self.coeff else f" (pair style {self.name} does not mix)"))
        return out

    def constants(self, settings: Mapping[str, Any]) -> Mapping[str, Any]:
        """What the functions may take besides coefficients: the settings. Override to add numbers that follow from them."""
        return settings

    def own_energy(self, settings: Mapping[str, Any], filled: Mapping[tuple[int, int], Mapping[str, Any]], ntypes: int,
                   qqr2e: float) -> np.ndarray | None:
        """For styles whose energy holds that of each charge by itself: the numbers of `asemd.kernels.own_energy` (2 or 5, ntypes + 1)."""

    def pack_pairs(self, settings: Mapping[str, Any], filled: Mapping[tuple[int, int], Mapping[str, Any]], ntypes: int, units,
                   shift: bool = False) -> PairTables:
        """Tables for the kernels; pairs that are not in `filled` have cut^2 = 0 and never interact.

        Parameters
        ----------
        shift : bool
            ``pair_modify shift yes``: the offset of parts without charges is their energy at the cutoff.
        """
        if self.derived:
            filled = {pair: {**c, **self.follow(pair, c, settings)} for pair, c in filled.items()}
        try:
            return pack_parts(self.parts, self.constants(settings), filled, ntypes, lambda c: self.cutoffs(c, settings),
                              shift and self.shifts, {p.name for p in self.coeff if p.unit == "angle"})
        except ArithmeticError:
            raise InputError(f"pair style {self.name}: a number is too large or too small for the formula, in its settings "
                             f"({stated(settings, self.settings)}) or coefficients") from None

    def follow(self, pair: tuple[int, int], c: Mapping[str, Any], settings: Mapping[str, Any]) -> Mapping[str, Any]:
        """What `derived` makes of the coefficients of a pair of types; zeros where no pair is within the cutoff of 0.

        Raises
        ------
        InputError
            The formula has no value for these coefficients.
        """
        try:
            out = self.derived(c, settings)
            if not any(isinstance(value, complex) for value in out.values()):
                return out
        except (ArithmeticError, ValueError):
            if not self.reach(c, settings) > 0.0:
                return {name: 0.0 for part in self.parts for name in part.rows if name not in c}
        raise InputError(f"pair style {self.name}, types {pair[0]} {pair[1]}: the formula has no value for {stated(c, self.coeff)}"
                         f"{' and ' + stated(settings, self.settings) if self.settings else ''}")


def stated(values: Mapping[str, Any], parameters: Sequence[Parameter]) -> str:
    """Names and values of parameters, for messages."""
    return ", ".join(f"{p.name} = {values[p.name]:g}" for p in parameters if isinstance(values.get(p.name), (int, float)))


def make_part(function: Callable, cut: str, by_pair) -> Part:
    """The `Part` of one function; arguments named in `by_pair` are rows, the others constants."""
    args = units_of(function)
    names = [n for n in args if n not in ("r", "r2", "qq", "radius_i", "radius_j")]
    return Part(function, "coul" if "qq" in args else "vdwl", cut,
                rows=tuple(n for n in names if n in by_pair and args[n] != "array"),
                constants=tuple(n for n in names if n not in by_pair and args[n] != "array"),
                arrays=tuple(n for n in names if args[n] == "array"),
                coordinate="r2" if "r2" in args else "r", charged="qq" in args, sized="radius_i" in args,
                long=getattr(function, "long", False))


def pack_parts(parts, constants, filled, ntypes: int, cutoffs: Callable, shift: bool, angles=frozenset(), arrays=()) -> PairTables:
    """`PairTables` of `parts` from complete coefficients by pair; `cutoffs(coeff)` gives the cutoff of each part."""
    rows = np.zeros((sum(2 + len(p.rows) for p in parts), ntypes + 1, ntypes + 1))
    numbers = [[float(constants[n]) for n in p.constants] for p in parts]
    for (i, j), c in filled.items():
        k = 0
        for part, fixed, cut in zip(parts, numbers, cutoffs(c), strict=True):
            values = [math.radians(c[n]) if n in angles else c[n] for n in part.rows]
            offset = 0.0
            if shift and not part.charged and cut > 0.0:
                offset = part.function(cut * cut if part.coordinate == "r2" else cut, *values, *fixed)[0]
            end = k + 2 + len(values)
            rows[k:end, i, j] = rows[k:end, j, i] = [cut * cut, offset, *values]
            k = end
    return PairTables(rows, np.array([x for fixed in numbers for x in fixed]), tuple(arrays))


def power_tail(terms, cut: float) -> tuple[float, float]:
    """Energy and pressure integrals beyond `cut` of a sum of powers, for the option `tail`.

    Parameters
    ----------
    terms : sequence of (float, float)
        Factor c and exponent n > 3 of each c / r^n.
    """
    energy = [2.0 * math.pi * c / ((n - 3.0) * cut ** (n - 3.0)) for c, n in terms]
    return sum(energy), sum(n * e / 3.0 for e, (_, n) in zip(energy, terms))


def largest_radii(system) -> tuple[float, ...]:
    """The largest radius of each type of atoms, from type 0 (unused) on."""
    out = np.zeros(system.counts["ntypes"] + 1)
    np.maximum.at(out, system.type, system.extra["radius"])
    return tuple(out.tolist())


def missing_pairs(pairs) -> str:
    """The message for type pairs without coefficients."""
    listed = ", ".join(f"{i} {j}" for i, j in pairs[:6]) + (", ..." if len(pairs) > 6 else "")
    return f"All pair coeffs are not set: pair_coeff for type pairs {listed} is missing"


def pair(name: str, **options):
    """Register one function as pair style `name`; its cutoff is the setting or coefficient ``cut``. Options as in `PairStyle`.

    `d2`, a function with the same arguments, gives the second derivative of the energy by the function's coordinate (for `asemd.hessian`).
    """
    def decorate(function):
        cls, function.d2 = options.pop("cls", PairStyle), options.pop("d2", None)
        doc = inspect.cleandoc(function.__globals__["__doc__"] or "")
        register(cls(name, [(function, options.pop("cut", "cut"))], doc=doc, **options))
        return function
    return decorate


def pair_sum(name: str, *parts: tuple[Callable, str], **options) -> PairStyle:
    """Register the fused sum of `parts` (function, name of its cutoff) as pair style `name`."""
    doc = inspect.cleandoc(sys._getframe(1).f_globals["__doc__"] or "")
    return register(options.pop("cls", PairStyle)(name, list(parts), doc=doc, **options))
