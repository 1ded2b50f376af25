r"""The registry: one style is one small file, found by its LAMMPS name.

``bond_style harmonic/shift/cut`` lives in ``asemd/bond/harmonic_shift_cut.py``; nothing else has to be edited to add a style.

A bonded style is a scalar function of internal coordinates and coefficients::

    @bond("harmonic", example="300.0 1.1")
    def harmonic(r, K: "energy/distance^2", r0: "distance"):
        dr = r - r0
        return K * dr * dr, 2 * K * dr

It returns the energy and then the derivative by each internal coordinate it names. Coordinates by category: ``r`` (bond);
``theta r12 r32 r13`` (angle, atom 2 in the middle); ``phi`` (dihedral, -pi..pi, trans = pi); ``phi chi omega`` (improper).
An energy or derivative that is not finite means "outside the domain" (write ``return math.inf, math.inf``): the kernel reports the item,
the user gets atom ids and ``domain``. Bodies are strict IEEE: write them so that no digits cancel (a product of sines for a difference of
cosines, ``(R0 - r) * (R0 + r)`` for a difference of squares) and so that plain Python runs them too (test before dividing by zero).

A pair style is a sum of parts, each a function of ``r2`` (or ``r``) that returns energy and derivative by that argument::

    @pair("lj/cut", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, example=...)
    def lj_cut(r2, epsilon: "energy", sigma: "distance"): ...

A part that takes ``qq`` (the product of charges times the Coulomb constant) is a Coulomb part: it follows the Coulomb special
factors and is counted as ``ecoul``. Cutoff, shift, mixing, special factors are axes around the function, never inside it.

Annotations are units ("energy/distance^2", see `asemd.units.factor`; "" for a bare number) or one of ``angle`` (degrees in text,
radians in the function), ``integer``, ``word``, ``path``, ``array`` (an array made by `Style.pack`, handed over whole).
Function bodies are compiled: only arithmetic, ``if``, and functions of ``math``; module constants must be written out.
"""
from __future__ import annotations

import importlib
import importlib.util
import inspect
import math
import pkgutil
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from asemd.errors import InputError, nearest

COORDINATES = {
    "bond": ("r",),
    "angle": ("theta", "r12", "r32", "r13"),
    "dihedral": ("phi",),
    "improper": ("phi", "chi", "omega"),
    "pair": ("r", "r2"),
}
ATOMS = {"bond": 2, "angle": 3, "dihedral": 4, "improper": 4}
ACCELERATED = ("/opt", "/omp", "/intel", "/kk", "/gpu")
_registry: dict[tuple[str, str], Style] = {}


@dataclass(frozen=True)
class Parameter:
    """One number or word of a style's command line; `default` names another parameter or is None when it must be given."""

    name: str
    unit: str = ""
    optional: bool = False
    default: Any = None

    def read(self, word: str, what: str) -> Any:
        if self.unit in ("word", "path"):
            return word
        try:
            value = int(word) if self.unit == "integer" else float(word)
        except ValueError:
            kind = "a whole number" if self.unit == "integer" else "a number"
            raise InputError(f"{what}: {self.name} must be {kind}, got {word!r}") from None
        if not math.isfinite(value):
            raise InputError(f"{what}: {self.name} is {word}, not a finite number")
        return value

    def write(self, value: Any) -> str:
        return repr(float(value)) if isinstance(value, float) else str(value)


def _names(spec: str) -> list[tuple[str, bool]]:
    """``"epsilon sigma [cut]"`` -> [(epsilon, False), (sigma, False), (cut, True)]."""
    return [(w.strip("[]"), w.startswith("[")) for w in spec.split()]


def _annotations(function: Callable) -> dict[str, str]:
    out = {}
    for name, p in inspect.signature(function).parameters.items():
        note = p.annotation
        out[name] = "" if note is inspect.Parameter.empty else str(note).strip("'\"")
    return out


@dataclass(frozen=True)
class Packed:
    """What a kernel gets of a bonded style: `coeff (npar, ntypes+1)` in kernel units, and whole `arrays`."""

    coeff: np.ndarray
    arrays: tuple[np.ndarray, ...] = ()


class Style:
    """A force-field style: parsing and writing of its commands, and the function that kernels are made of.

    Parameters
    ----------
    category, name : str
        ``"bond"``, ``"harmonic"``.
    function : callable or None
        The scalar function; None for styles without forces (zero).
    settings : sequence of Parameter
        Words after the style name in ``bond_style``.
    coeff : sequence of Parameter
        Words after the type in ``bond_coeff``; by default the parameters of the function.
    example, settings_example : str
        One valid line of coefficients and of settings, used by docs and tests.
    domain : str
        Where the function is defined, in words a user understands.
    equilibrium : str
        Name of the coefficient that is the rest length or angle (used by SHAKE).
    see : str
        Source of the formula (paper or manual page).
    xfail : mapping
        Shipped check (`asemd.testing.styles.CHECKS`) -> reason it cannot hold.
    check : callable, optional
        ``check(coeff, settings)`` raises `InputError` for coefficients that make no sense.
    weight_14 : str
        Name of the coefficient that scales the pair interaction of atoms 1 and 4 (dihedral charmm).
    """

    def __init__(self, category: str, name: str, function: Callable | None, *, settings=(), coeff=None, example: str = "",
                 settings_example: str = "", domain: str = "", equilibrium: str = "", see: str = "",
                 xfail: Mapping[str, str] = MappingProxyType({}), check: Callable | None = None, weight_14: str = "", doc: str = ""):
        self.category, self.name, self.function = category, name, function
        self.example, self.settings_example, self.domain = example, settings_example, domain
        self.equilibrium, self.see, self.xfail = equilibrium, see, dict(xfail)
        self.weight_14, self._check = weight_14, check
        notes = _annotations(function) if function else {}
        vocabulary = COORDINATES[category] + ("qq",)
        self.coordinates = tuple(n for n in notes if n in vocabulary)
        self.arguments = tuple(n for n in notes if n not in vocabulary)
        self.arrays = tuple(n for n in self.arguments if notes[n] == "array")
        self.settings = tuple(settings)
        self.coeff = tuple(coeff) if coeff is not None else tuple(
            Parameter(n, notes[n]) for n in self.arguments if notes[n] != "array")
        self.doc = doc or (inspect.getdoc(inspect.getmodule(function)) or "" if function else "")

    def __repr__(self) -> str:
        return f"<{self.category} style {self.name}>"

    def __reduce__(self):
        return find, (self.category, self.name)

    # text -> values -> text
    def _read(self, words: list[str], parameters: tuple[Parameter, ...], command: str) -> dict[str, Any]:
        must = [p for p in parameters if not p.optional]
        if not len(must) <= len(words) <= len(parameters):
            form = " ".join(f"[{p.name}]" if p.optional else p.name for p in parameters) or "no values"
            raise InputError(f"{command} {self.name} needs {form}, got {len(words)} value{'s' * (len(words) != 1)}")
        return {p.name: p.read(w, f"{command} {self.name}") for p, w in zip(parameters, words)}

    def parse_settings(self, words: list[str]) -> dict[str, Any]:
        """Words after the style's name in ``*_style`` -> values."""
        return self._read(words, self.settings, f"{self.category}_style")

    def parse_coeff(self, words: list[str], settings: Mapping[str, Any]) -> dict[str, Any]:
        """Words after the type in ``*_coeff`` -> values, in file units (angles in degrees)."""
        values = self._read(words, self.coeff, f"{self.category}_coeff")
        self.check(values, settings)
        return values

    def check(self, coeff: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
        """Refuse coefficients that make no sense, by the option `check` or by overriding.

        Raises
        ------
        InputError
            The message names the command, the style and the coefficient.
        """
        if self._check:
            self._check(coeff, settings)

    def format_settings(self, settings: Mapping[str, Any]) -> list[str]:
        return [p.write(settings[p.name]) for p in self.settings if p.name in settings]

    def format_coeff(self, coeff: Mapping[str, Any]) -> list[str]:
        return [p.write(coeff[p.name]) for p in self.coeff if p.name in coeff]

    # values -> kernel
    def pack(self, settings: Mapping[str, Any], coeffs: Mapping[int, Mapping[str, Any]], ntypes: int, units) -> Packed:
        """Coefficients of all types as one array, a row for each non-array argument of the function, angles in radians.

        Override for styles whose function takes something else than the user gives (tables, derived constants).
        """
        unit = {p.name: p.unit for p in self.coeff}
        names = [n for n in self.arguments if n not in self.arrays]
        out = np.zeros((len(names), ntypes + 1))
        for t, values in coeffs.items():
            for k, name in enumerate(names):
                out[k, t] = math.radians(values[name]) if unit[name] == "angle" else values[name]
        return Packed(out)

    def functions(self) -> tuple[Callable, ...]:
        """The functions a generated kernel needs, the scalar one last."""
        return (self.function,) if self.function else ()


class ZeroStyle(Style):
    """No forces: keeps lists and rest values. With the setting ``nocoeff`` every coefficient word is taken and forgotten."""

    def __init__(self, category: str, coeff: tuple[Parameter, ...] = (), **options):
        super().__init__(category, "zero", None, coeff=coeff, settings=(Parameter("nocoeff", "word", True),), settings_example="nocoeff",
                         example=" ".join(["1.0"] * len(coeff)), **options)

    def parse_settings(self, words):
        if words not in ([], ["nocoeff"]):
            raise InputError(f"{self.category}_style zero takes no word but nocoeff, got {' '.join(words)!r}")
        return {"nocoeff": "nocoeff"} if words else {}

    def parse_coeff(self, words, settings):
        return {} if "nocoeff" in settings else super().parse_coeff(words, settings)


def register(style: Style) -> Style:
    _registry[style.category, style.name] = style
    return style


def _bonded(category: str, name: str, options: Mapping[str, Any]):
    cls = options.pop("cls", Style)

    def decorate(function):
        register(cls(category, name, function, **options))
        return function
    return decorate


def bond(name: str, **options):
    """Register ``f(r, ...) -> E, dE/dr`` as bond style `name`; options as in `Style`."""
    return _bonded("bond", name, options)


def angle(name: str, **options):
    """Register ``f(theta, [r12, r32, r13,] ...) -> E, dE/dtheta, ...`` as angle style `name`."""
    return _bonded("angle", name, options)


def dihedral(name: str, **options):
    """Register ``f(phi, ...) -> E, dE/dphi`` as dihedral style `name`."""
    return _bonded("dihedral", name, options)


def improper(name: str, **options):
    """Register ``f(phi | chi | omega, ...) -> E, dE/d...`` as improper style `name`."""
    return _bonded("improper", name, options)


# ------------------------------------------------------------------ pair ---

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
        ``sixthpower``, or ``geometric`` whatever the rule. Cutoffs mix as distances. Empty: i-j must be given. `mix_rule` is the
        default rule.
    tail : callable, optional
        ``tail(coeff, cut) -> (e, p)``: integrals for ``pair_modify tail yes`` of one type pair (energy and pressure, without the
        factors of number and volume), see `asemd/pair/lj_cut.py`.
    units : mapping
        Units of settings and coefficients that no function argument names.
    rows : str
        Names of function arguments that differ by pair of types but are not words of ``pair_coeff`` (`pack_pairs` makes them).
    """

    twin: PairStyle | None = None    # gives LAMMPS's numbers where LAMMPS's force is not minus the gradient of its energy

    def __init__(self, name: str, parts, *, settings="", coeff="", defaults=MappingProxyType({}), mix=MappingProxyType({}),
                 mix_rule="geometric", tail=None, units=MappingProxyType({}), rows="", **options):
        notes = dict(units)
        for function, _ in parts:
            notes = {**_annotations(function), **notes}
        self.mix, self.mix_rule, self.tail = dict(mix), mix_rule, tail

        def parameters(spec):
            return tuple(Parameter(n, notes.get(n) or ("distance" if n.startswith(("cut", "inner", "outer")) else ""), optional,
                                   defaults.get(n)) for n, optional in _names(spec))
        main = parts[0][0] if parts else None
        super().__init__("pair", name, main, settings=parameters(settings), coeff=parameters(coeff), **options)
        mine = {p.name for p in self.coeff} | set(rows.split())
        self.parts = tuple(make_part(function, cut, mine) for function, cut in parts)
        self.charged = any(p.charged for p in self.parts)

    def functions(self):
        return tuple(p.function for p in self.parts)

    def variant(self, settings: Mapping[str, Any], compat: str = "") -> PairStyle:
        """The style whose parts are computed: this one, unless settings or ``compat="lammps"`` ask for other functions."""
        return self.twin if compat == "lammps" and self.twin else self

    def parse_settings(self, words):
        values = super().parse_settings(words)
        for p in self.settings:
            if p.name not in values and p.default is not None:
                values[p.name] = values[p.default] if isinstance(p.default, str) else p.default
        for p in self.settings:
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
            elif i != j and self.mix and (i, i) in coeffs and (j, j) in coeffs:
                a, b = self.complete(coeffs[i, i], settings), self.complete(coeffs[j, j], settings)
                try:
                    out[i, j] = self.mixed(a, b, rule or self.mix_rule)
                except InputError as e:
                    raise InputError(f"pair style {self.name}, types {i} {j}: {e.message}") from None
            else:
                missing.append((i, j))
        if missing:
            raise InputError(missing_pairs(missing) + ("" if self.mix else f" (pair style {self.name} does not mix)"))
        return out

    def constants(self, settings: Mapping[str, Any]) -> Mapping[str, Any]:
        """What the functions may take besides coefficients: the settings. Override to add numbers that follow from them."""
        return settings

    def pack_pairs(self, settings: Mapping[str, Any], filled: Mapping[tuple[int, int], Mapping[str, Any]], ntypes: int, units,
                   shift: bool = False) -> PairTables:
        """Tables for the kernels; pairs that are not in `filled` have cut^2 = 0 and never interact.

        Parameters
        ----------
        shift : bool
            ``pair_modify shift yes``: the offset of parts without charges is their energy at the cutoff.
        """
        return pack_parts(self.parts, self.constants(settings), filled, ntypes, lambda c: self.cutoffs(c, settings), shift,
                          {p.name for p in self.coeff if p.unit == "angle"})


def make_part(function: Callable, cut: str, by_pair) -> Part:
    """The `Part` of one function; arguments named in `by_pair` are rows, the others constants."""
    args = _annotations(function)
    names = [n for n in args if n not in ("r", "r2", "qq")]
    return Part(function, "coul" if "qq" in args else "vdwl", cut,
                rows=tuple(n for n in names if n in by_pair and args[n] != "array"),
                constants=tuple(n for n in names if n not in by_pair and args[n] != "array"),
                arrays=tuple(n for n in names if args[n] == "array"),
                coordinate="r2" if "r2" in args else "r", charged="qq" in args)


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


def missing_pairs(pairs) -> str:
    """The message for type pairs without coefficients."""
    listed = ", ".join(f"{i} {j}" for i, j in pairs[:6]) + (", ..." if len(pairs) > 6 else "")
    return f"All pair coeffs are not set: pair_coeff for type pairs {listed} is missing"


def pair(name: str, **options):
    """Register one function as pair style `name`; its cutoff is the setting or coefficient ``cut``. Options as in `PairStyle`."""
    cls = options.pop("cls", PairStyle)

    def decorate(function):
        cut = options.pop("cut", "cut")
        register(cls(name, [(function, cut)], doc=inspect.getdoc(inspect.getmodule(function)) or "", **options))
        return function
    return decorate


def pair_sum(name: str, *parts: tuple[Callable, str], **options) -> PairStyle:
    """Register the fused sum of `parts` (function, name of its cutoff) as pair style `name`."""
    doc = inspect.getdoc(inspect.getmodule(inspect.stack()[1][0])) or ""
    return register(options.pop("cls", PairStyle)(name, list(parts), doc=doc, **options))


# -------------------------------------------------------------- registry ---

def module_of(category: str, name: str) -> str:
    """The module of a style or command follows from its LAMMPS name."""
    return f"asemd.{category}." + re.sub(r"[^0-9a-zA-Z]", "_", name)


def names(category: str) -> list[str]:
    """LAMMPS names of all styles of a category that exist (imports them)."""
    package = importlib.import_module(f"asemd.{category}")
    for m in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"asemd.{category}.{m.name}")
    return sorted(n for c, n in _registry if c == category)


def plain_name(name: str) -> str:
    """A style's name without LAMMPS's accelerator suffixes."""
    for suffix in ACCELERATED:
        name = name.removesuffix(suffix)
    return name


def exists(category: str, name: str) -> bool:
    """Whether there is a style of that name; imports its one file."""
    if not re.match(r"[A-Za-z]", name):
        return False
    module = module_of(category, name)
    if (category, name) not in _registry and importlib.util.find_spec(module) is not None:
        importlib.import_module(module)
    return (category, name) in _registry


def find(category: str, name: str) -> Style:
    """The style of that LAMMPS name; imports its one file.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    name = plain_name(name)
    if (category, name) not in _registry:
        module = module_of(category, name)
        try:
            importlib.import_module(module)
        except ModuleNotFoundError as e:
            if e.name != module:
                raise
        if (category, name) not in _registry:
            raise InputError(f"unknown {category} style {name!r}{nearest(name, names(category))}")
    return _registry[category, name]


def class_of(category: str, name: str, base: type) -> type:
    """The class of a fix, compute, dump ... of that LAMMPS name; imports its one file.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    for suffix in ACCELERATED:
        name = name.removesuffix(suffix)
    module = module_of(category, name)
    try:
        found = _styled(importlib.import_module(module), base)
    except ModuleNotFoundError as e:
        if e.name != module:
            raise
        found = None
    if found is None or found.style != name:
        raise InputError(f"unknown {category} style {name!r}{nearest(name, class_names(category, base))}")
    return found


def class_names(category: str, base: type) -> list[str]:
    """LAMMPS names of all classes of a category that exist (imports them)."""
    package = importlib.import_module(f"asemd.{category}")
    found = (_styled(importlib.import_module(f"asemd.{category}.{m.name}"), base) for m in pkgutil.iter_modules(package.__path__))
    return sorted(c.style for c in found if c)


def class_called(category: str, name: str, base: type) -> type:
    """The class with that Python name: `TempCSVR` of the style ``temp/csvr``, for a package's ``__getattr__``."""
    if not name.startswith("_"):
        package = importlib.import_module(f"asemd.{category}")
        for m in pkgutil.iter_modules(package.__path__):
            if m.name.replace("_", "") == name.lower():
                found = _styled(importlib.import_module(f"asemd.{category}.{m.name}"), base)
                if found and found.__name__ == name:
                    return found
    raise AttributeError(f"asemd.{category} has no class {name}")


def _styled(module, base: type) -> type | None:
    """The style class that a module defines."""
    own = (c for c in vars(module).values() if isinstance(c, type) and issubclass(c, base) and c.__module__ == module.__name__)
    return next((c for c in own if c.style), None)
