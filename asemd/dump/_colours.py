"""Colours of pictures: names, elements, and maps from numbers to colours."""
from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from asemd.errors import InputError, nearest
from asemd.words import number, take, whole

# LAMMPS's default colours of types 1 2 3 ... (red green blue yellow aqua cyan), in shades that can be looked at
TYPES = {"red": (0.84, 0.20, 0.18), "green": (0.22, 0.62, 0.27), "blue": (0.16, 0.42, 0.78), "yellow": (0.96, 0.78, 0.22),
         "aqua": (0.16, 0.72, 0.70), "cyan": (0.45, 0.80, 0.93)}


def rgb(name: str, own: Mapping[str, tuple], what: str) -> tuple[float, float, float]:
    """Red, green and blue from 0 to 1 of a colour name; `own` has the names that the user defined.

    Raises
    ------
    InputError
        No colour of that name.
    """
    if name in own:
        return own[name]
    from matplotlib.colors import CSS4_COLORS, to_rgb
    if name not in CSS4_COLORS:
        raise InputError(f"{what}: unknown colour {name!r}{nearest(name, [*own, *CSS4_COLORS])}; define it with dump_modify color")
    return to_rgb(name)


def element_colour(symbol: str, what: str) -> tuple[float, float, float]:
    from ase.data.colors import jmol_colors
    return tuple(jmol_colors[_atomic_number(symbol, what)])


def element_diameter(symbol: str, what: str) -> float:
    """Diameter to draw an element with, Angstrom: a good half of twice its covalent radius, so that bonds show."""
    from ase.data import covalent_radii
    return 1.25 * float(covalent_radii[_atomic_number(symbol, what)])


def _atomic_number(symbol: str, what: str) -> int:
    from ase.data import atomic_numbers
    if symbol not in atomic_numbers:
        raise InputError(f"{what}: {symbol!r} is not an element{nearest(symbol, atomic_numbers)}: use dump_modify element")
    return atomic_numbers[symbol]


@dataclass
class ColourMap:
    """``amap lo hi style delta N entries``: numbers to colours.

    Attributes
    ----------
    lo, hi : float or None
        Range; None: smallest or largest value of the picture.
    kind : str
        ``c`` continuous, ``d`` discrete, ``s`` sequential.
    fractional : bool
        Whether the values of the entries run from 0 to 1 over the range.
    width : float
        Width of the bins of a sequential map.
    entries : list
        ``(value, colour)``, ``(lo, hi, colour)`` or ``(colour,)``; -inf and inf for ``min`` and ``max``.
    """

    lo: float | None = None
    hi: float | None = None
    kind: str = "c"
    fractional: bool = True
    width: float = 0.0
    entries: tuple = ((-np.inf, TYPES["blue"]), (0.5, (0.93, 0.93, 0.93)), (np.inf, TYPES["red"]))

    @classmethod
    def from_words(cls, words: list[str], own: Mapping[str, tuple], what: str) -> tuple[ColourMap, int]:
        """The map, and how many words it took."""
        lo, hi, style, delta, count = take(words, 5, what)
        if not re.fullmatch(r"[cds][af]", style):
            raise InputError(f"{what}: expected a style such as cf, ca, df, da, sf or sa, got {style!r}")
        n, size = whole(count, what), {"c": 2, "d": 3, "s": 1}[style[0]]
        if n < (2 if style[0] == "c" else 1):
            raise InputError(f"{what}: needs {'at least two entries' if style[0] == 'c' else 'entries'}, got {n}")
        rest = take(words[5:], n * size, what)
        entries = tuple((*(_limit(w, what) for w in e[:-1]), rgb(e[-1], own, what)) for e in (rest[k:k + size] for k in
                                                                                              range(0, n * size, size)))
        out = cls(None if lo == "min" else number(lo, what), None if hi == "max" else number(hi, what), style[0], style[1] == "f",
                  number(delta, what), entries)
        if style[0] == "s" and out.width <= 0.0:
            raise InputError(f"{what}: the bins of a sequential map need a positive width, got {delta}")
        if style[0] == "c":
            values = [e[0] for e in entries]
            if values[0] != -np.inf or values[-1] != np.inf or values != sorted(values):
                raise InputError(f"{what}: the entries of a continuous map must run from min to max, in order")
        if style[0] == "d" and entries[-1][:2] != (-np.inf, np.inf):
            raise InputError(f"{what}: the last entry of a discrete map must be min max colour")
        if out.lo is not None and out.hi is not None and out.lo > out.hi:
            raise InputError(f"{what}: the lower bound {lo} is above the upper bound {hi}")
        return out, 5 + n * size

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Colours (n, 3) of numbers (n,)."""
        if not len(values):
            return np.zeros((0, 3))
        lo, hi = values.min() if self.lo is None else self.lo, values.max() if self.hi is None else self.hi
        span = hi - lo if hi > lo else 1.0
        x = np.clip(values, lo, hi)
        colours = np.array([e[-1] for e in self.entries])
        if self.kind == "s":
            x = (x - lo) / span if self.fractional else x - lo
            return colours[(x / self.width).astype(int) % len(colours)]
        scale = (lambda v: lo + v * span) if self.fractional else (lambda v: v)
        at = [[{-np.inf: lo, np.inf: hi}.get(v, scale(v)) for v in e[:-1]] for e in self.entries]
        if self.kind == "c":
            return np.column_stack([np.interp(x, [v for v, in at], colours[:, k]) for k in range(3)])
        out = np.tile(colours[-1], (len(x), 1))
        for (first, last), colour in reversed(list(zip(at, colours))):
            out[(x >= first) & (x <= last)] = colour
        return out


def _limit(word: str, what: str) -> float:
    return {"min": -np.inf, "max": np.inf}.get(word) if word in ("min", "max") else number(word, what)
