r"""What a style is: one small file, found by its LAMMPS name (`find`).

``bond_style harmonic/shift/cut`` lives in ``asemd/bond/harmonic_shift_cut.py``; nothing else has to be edited to add a style.

A bonded style is a scalar function of internal coordinates and coefficients::

    @bond("harmonic", example="300.0 1.1")
    def harmonic(r, K: "energy/distance^2", r0: "distance"):
        dr = r - r0
        return K * dr * dr, 2 * K * dr

It returns the energy and then the derivative by each internal coordinate it names, in the order of its arguments. Coordinates by category:
``r`` (bond); ``theta r12 r32 r13`` (angle, atom 2 in the middle) or ``gamma`` (between the dipole of atom 1 and the vector to atom 2);
``phi r12 r23 r34 theta1 theta2`` (dihedral; phi in -pi..pi with trans = pi, theta1 is the angle 1-2-3, theta2 the angle 2-3-4); ``phi`` or
its size ``chi`` (improper). Bonds with a past also take ``rate``, dr/dt, and ``reference``, a length that each bond has for itself; they
have no derivatives. A style that has no such coordinate takes vectors instead, ``ax ay az bx by bz`` and for four atoms ``cx cy cz``: from
the atom `centre` (1, 2, ...) to the others in their order; it returns the energy and the six or nine derivatives.
An energy or derivative that is not finite means "outside the domain" (write ``return math.inf, math.inf``): the kernel reports the item,
the user gets atom ids and ``domain``. Bodies are strict IEEE: write them so that no digits cancel (a product of sines for a difference of
cosines, ``(R0 - r) * (R0 + r)`` for a difference of squares) and so that plain Python runs them too (test before dividing by zero).

Pair styles have another shape, see `asemd.pairstyle`.

Annotations are units ("energy/distance^2", see `asemd.units.factor`; "" for a bare number) or one of ``angle`` (degrees in text,
radians in the function), ``integer``, ``word``, ``path``, ``array`` (an array made by `Style.pack`, handed over whole).
Function bodies are compiled: only arithmetic, ``if``, and functions of ``math``; module constants must be written out.
"""
from __future__ import annotations

import ast
import copy
import inspect
import math
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.registry import exists, find, module_of, names, register
from asemd.words import real

__all__ = ["Packed", "Parameter", "Style", "ZeroStyle", "angle", "bond", "dihedral", "exists", "find", "improper", "module_of", "names",
           "radians", "register", "units_of"]
VECTORS = ("ax", "ay", "az", "bx", "by", "bz", "cx", "cy", "cz")
COORDINATES = {
    "bond": ("r", "rate", "reference"),
    "angle": ("theta", "r12", "r32", "r13", "gamma", *VECTORS[:6]),
    "dihedral": ("phi", "r12", "r23", "r34", "theta1", "theta2", *VECTORS),
    "improper": ("phi", "chi", *VECTORS),
    "pair": ("r", "r2", "radius_i", "radius_j"),
}
DEAR = {f"math.{name}" for name in ("exp", "log", "erfc", "pow", "sin", "cos")}
RADIAN = Fraction("0.0174532925199432957692369076848861271344287188854172545609719144")


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
            value: float = real(word)
            if self.unit == "integer":
                value = int(word)
        except ValueError:
            kind = "a whole number" if self.unit == "integer" else "a number"
            raise InputError(f"{what}: {self.name} must be {kind}, got {word!r}") from None
        if not math.isfinite(value):
            raise InputError(f"{what}: {self.name} is {word}, not a finite number")
        if self.unit == "integer" and abs(value) >= 2**31:
            raise InputError(f"{what}: {self.name} is too large, got {word}")
        return value

    def write(self, value: Any) -> str:
        return repr(float(value)) if isinstance(value, float) else str(value)


def radians(degrees: float) -> float:
    """Degrees in radians, rounded once; `math.radians` rounds twice."""
    return float(Fraction(degrees) * RADIAN)


def units_of(function: Callable) -> dict[str, str]:
    """The annotation of each argument of a style function."""
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
    rest : callable, optional
        ``rest(coeff)``, the rest length or angle (degrees) where it is not a coefficient.
    see : str
        Source of the formula (paper or manual page).
    xfail : mapping
        Shipped check (`asemd.testing.styles.CHECKS`) -> reason it cannot hold.
    check : callable, optional
        ``check(coeff, settings)`` raises `InputError` for coefficients that make no sense.
    weight_14 : str
        Name of the coefficient that scales the pair interaction of atoms 1 and 4 (dihedral charmm).
    centre : int
        The atom from which the vectors of a style of vectors start, counted from 1; by default 2 for angles and dihedrals, 1 for impropers.
    chain : bool
        Of three vectors the last one starts from the end of the second one, so that short bonds keep their digits.
    breaks : str
        What becomes of a bond for which the function returns ``math.nan``: ``off`` gives it type 0, and its pair interaction, which the
        bond replaces, comes back at once; ``removed`` takes it out, and the pair is no longer a special one from the next step on.
    remembers : str
        Where ``reference`` comes from: ``atoms`` (positions at the start of the first run) or ``bonds`` (length at their first force).
    edge : bool
        The energy of vectors has an edge in the plane of the atoms: there, where the function pushes to the positive side, no force acts.
    pair_weights : (str, str)
        Coefficients that weigh the Lennard-Jones and Coulomb part of the pair interaction, which is all the energy of the bond.
    lammps : callable, optional
        LAMMPS's forces where they are not minus the gradient of its energy: a function like `function`, for ``compat="lammps"``.
    straight : callable, optional
        The energy of a torsion three of whose atoms lie on a line, a function of the coefficients; by default that of 90 degrees.
    d2 : callable, optional
        Second derivatives of the energy by the coordinates: a function with the arguments of `function` that returns one number for one
        coordinate, a tuple of rows for several (for `asemd.hessian`).
    """

    def __init__(self, category: str, name: str, function: Callable | None, *, settings=(), coeff=None, example: str = "",
                 settings_example: str = "", domain: str = "", equilibrium: str = "", see: str = "",
                 xfail: Mapping[str, str] = MappingProxyType({}), check: Callable | None = None, weight_14: str = "", doc: str = "",
                 centre: int = 0, lammps: Callable | None = None, rest: Callable | None = None,
                 d2: Callable | None = None, straight: Callable | None = None, breaks: str = "", remembers: str = "",
                 chain: bool = False, edge: bool = False, pair_weights: tuple[str, str] | tuple[()] = ()):
        self.category, self.name, self.function = category, name, function
        self.example, self.settings_example, self.domain = example, settings_example, domain
        self.equilibrium, self.rest, self.see, self.xfail = equilibrium, rest, see, dict(xfail)
        self.weight_14, self._check, self.lammps, self.d2, self.straight = weight_14, check, lammps, d2, straight
        self.breaks, self.remembers, self.pair_weights, self.chain = breaks, remembers, pair_weights, chain
        self.edge = edge
        self.centre = centre or (1 if category == "improper" else 2)
        notes = units_of(function) if function else {}
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

    def __copy__(self):
        twin = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        return twin

    @property
    def history(self) -> bool:
        """Whether bonds of this style have a past: they break, or remember a length."""
        return bool(self.breaks or self.remembers)

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

    def check_scene(self, interactions, system) -> None:
        """Refuse a scene in which the style does not work; called before a run.

        Raises
        ------
        InputError
            The message says what the style needs.
        """

    def format_settings(self, settings: Mapping[str, Any]) -> list[str]:
        return [p.write(settings[p.name]) for p in self.settings if p.name in settings]

    def format_coeff(self, coeff: Mapping[str, Any]) -> list[str]:
        return [p.write(coeff[p.name]) for p in self.coeff if p.name in coeff]

    # styles with coefficients on several lines override these three, see `asemd.cross_terms`
    def join(self, old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
        """Coefficients of a type that had `old` ones when a line with `new` ones comes."""
        return dict(new)

    def coeff_lines(self, coeff: Mapping[str, Any]) -> list[list[str]]:
        """Words of all lines that make the coefficients of a type again."""
        return [self.format_coeff(coeff)]

    def lines(self, coeffs: Mapping[Any, Mapping[str, Any]]) -> list[tuple[Any, list[str], list[str]]]:
        """All lines of ``*_coeff``: the type or pair of types to sort them by, the words of the types, the other words."""
        return [(key, [str(k) for k in key] if isinstance(key, tuple) else [str(key)], line)
                for key, c in coeffs.items() for line in self.coeff_lines(c)]

    def keys(self, values: Mapping[str, Any], keys: list) -> list:
        """The types (or pairs of types), of those of the command, that these coefficients are for."""
        return keys

    def rest_value(self, coeff: Mapping[str, Any]) -> float:
        """Rest length, or rest angle in degrees, of a type with these coefficients; nan if the style has none."""
        value = self.rest(coeff) if self.rest else coeff.get(self.equilibrium)
        return math.nan if value is None else float(value)

    def missing(self, coeff: Mapping[str, Any]) -> list[str]:
        """Marks of the lines that a type still needs."""
        return []

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
                out[k, t] = radians(values[name]) if unit[name] == "angle" else values[name]
        return Packed(out)

    def bind(self, settings: Mapping[str, Any], coeffs: Mapping[int, Mapping[str, Any]], compat: str = "") -> Style:
        """The style whose kernel is made for these coefficients; another one if it depends on them or `compat` asks for LAMMPS's forces."""
        if compat == "lammps" and self.lammps:
            twin = copy.copy(self)
            twin.function = self.lammps
            return twin
        return self

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
    """Register ``f(phi | chi, ...) -> E, dE/d...`` as improper style `name`."""
    return _bonded("improper", name, options)


def text_of(function: Callable) -> str:
    """Source of a function: of its file, or the attribute ``source`` of one that was written by a program."""
    return getattr(function, "source", None) or textwrap.dedent(inspect.getsource(inspect.unwrap(function)))


@cache
def operations(*functions: Callable) -> int:
    """Of formulas: arithmetic, exponential functions and their like counting twenty."""
    nodes = [node for f in functions for node in ast.walk(ast.parse(text_of(f)))]
    return (sum(isinstance(node, ast.BinOp) for node in nodes)
            + 20 * sum(isinstance(node, ast.Call) and ast.unparse(node.func) in DEAR for node in nodes))
