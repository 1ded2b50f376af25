r"""Energy and force read from a file.

``pair_style table linear 1000`` and ``pair_coeff 1 2 file KEYWORD [cut]``. Cubic splines through the values of the file give energy
and force/r at the N points of ``pair_style``, equally spaced in r^2 (bitmap: at 2^N values of r^2 in single precision with trailing bits
zero). In between they are interpolated: ``lookup`` takes the value at the middle of the interval, ``linear`` and ``bitmap`` a line,
``spline`` a cubic spline. The force is that of the file, not the derivative of the interpolated energy. A distance below the table is an
error.
"""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd import tabulated, words
from asemd.errors import InputError, InputWarning
from asemd.pairstyle import PairStyle, PairTables
from asemd.style import register
from asemd.tabulated import clamped_spline, cubic_coefficients, spline_value

METHODS = ("lookup", "linear", "spline", "bitmap")
KEYWORDS = ("ewald", "pppm", "msm", "dispersion", "tip4p")
KNOWN = {"N": 1, "R": 2, "RSQ": 2, "BITMAP": 2, "FPRIME": 2}
EV = 23.060549     # kcal/mol, LAMMPS's factor between real and metal
CONVERT = {("metal", "real"): EV, ("real", "metal"): 1.0 / EV}
SECANT = 0.1       # step of the one-sided difference that gives the end slopes of force/r, in intervals


def table(r2, index, inner2, scale, last, pieces: "array"):
    i = int(index)
    t = (r2 - inner2) * scale
    k = int(min(max(t, 0.0), last))
    b = t - k
    e = pieces[i, k, 0] + b * (pieces[i, k, 1] + b * (pieces[i, k, 2] + b * pieces[i, k, 3]))
    f = pieces[i, k, 4] + b * (pieces[i, k, 5] + b * (pieces[i, k, 6] + b * pieces[i, k, 7]))
    return (e, -0.5 * f) if r2 >= inner2 else (math.nan, math.nan)


def table_bitmap(r2, index, inner2, scale, first, pieces: "array"):
    i = int(index)
    mantissa, exponent = math.frexp(np.float64(np.float32(r2)))
    t = (2.0 * mantissa - 1.0 + exponent) * scale - first
    k = min(max(int(t), 0), pieces.shape[1] - 1)
    b = t - k
    e = pieces[i, k, 0] + b * pieces[i, k, 1]
    f = pieces[i, k, 2] + b * pieces[i, k, 3]
    return (e, -0.5 * f) if r2 >= inner2 else (math.nan, math.nan)


class FileTable:
    """What a section of a table file says: distances, energies, forces, range, slopes of the force at the ends if given."""

    def __init__(self, section: tabulated.Section):
        self.section, p = section, section.parameters
        self.e, self.f = section.columns[:, 2], section.columns[:, 3]
        n = len(self.e)
        given = [k for k in p if k in ("R", "RSQ", "BITMAP")]
        self.kind, what = given[-1] if given else "", "pair_coeff table"
        self.slopes = p.get("FPRIME")
        self.lo, self.hi = p[self.kind] if given else (float(section.columns[0, 1]), float(section.columns[-1, 1]))
        if not 0.0 < self.lo < self.hi:
            raise InputError(f"pair table {section.keyword}: distances must be positive and increase", section.where)
        i = np.arange(n) / (n - 1)
        if self.kind == "R":
            self.r = self.lo + (self.hi - self.lo) * i
        elif self.kind == "RSQ":
            self.r = np.sqrt(self.lo**2 + (self.hi**2 - self.lo**2) * i)
        else:
            self.r = section.columns[:, 1]
        if self.kind != "BITMAP":
            section.check_increasing(self.r, what)
            section.check_slopes(self.r, self.e, self.f, what)
        far = int(np.count_nonzero(np.abs(self.r - section.columns[:, 1]) > 1e-6 * self.r))
        if far:
            warnings.warn(f"{what}: {far} of {n} distances in table {section.keyword} differ by more than 1e-6 from those that {self.kind} "
                          f"says ({section.where})", InputWarning, stacklevel=2)

    def sample(self, r: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray]:
        """Energy and force at distances, by the splines through the values of the file, times `unit`."""
        x, e, f = self.r, self.e * unit, self.f * unit
        lo, hi = self.slopes or ((self.f[1] - self.f[0]) / (x[1] - x[0]), (self.f[-1] - self.f[-2]) / (x[-1] - x[-2]))
        return (spline_value(x, e, clamped_spline(x, e, -f[0], -f[-1]), r),
                spline_value(x, f, clamped_spline(x, f, lo * unit, hi * unit), r))


class Grid:
    """Style bitmap's grid: 2^bits consecutive single-precision r^2 whose bits below the leading ones are zero."""

    def __init__(self, inner: float, outer: float, bits: int, what: str):
        lowest = math.frexp(inner * inner)[1] - 1
        span, exponent_bits = outer * outer / 2.0**lowest, 0
        while 2.0 ** (2.0**exponent_bits) < span:
            exponent_bits += 1
        mantissa_bits = bits - exponent_bits
        if not 3 <= mantissa_bits <= 22:
            few = "few" if mantissa_bits < 3 else "many"
            raise InputError(f"{what}: 2^{bits} values are too {few} for a bitmap from {inner:g} to {outer:g}")
        shift = 23 - mantissa_bits
        self.scale = float(1 << mantissa_bits)
        number = int(np.float32(inner * inner).view(np.int32)) >> shift
        if np.int32(number << shift).view(np.float32) < inner * inner:
            number += 1
        numbers = number + np.arange(1 << bits)
        single = (numbers << shift).astype(np.int32).view(np.float32)
        self.r2 = single.astype(float)
        self.r = np.sqrt(self.r2)
        self.width = np.ldexp(0.5, np.frexp(self.r2)[1]) / self.scale      # length of the interval above each node
        mantissa, exponent = math.frexp(self.r2[0])
        self.first = (2.0 * mantissa - 1.0 + exponent) * self.scale
        self.line = numbers % (1 << bits)                                  # where a BITMAP file has each node


def bitmap_pieces(file: FileTable, n: int, cut: float, unit: float, what: str):
    """Lines (2^n, 4) from node to node for energy and force/r, and inner cutoff^2, scale and place of the first node."""
    grid = Grid(file.lo, cut, n, what)
    if file.kind == "BITMAP":
        e, force = file.e[grid.line] * unit, file.f[grid.line] * unit
    else:
        e, force = file.sample(grid.r, unit)
    g = force / grid.r
    rise = np.array([np.append(np.diff(y), 0.0) for y in (e, g)])
    end = cut * cut - grid.r2[-1]
    if end > 0.0:      # the last interval ends at the cutoff
        if file.kind == "BITMAP":
            slope = rise[:, -2] / (grid.r2[-1] - grid.r2[-2])
        else:
            at, push = file.sample(np.array([cut]), unit)
            slope = np.array([at[0] - e[-1], push[0] / cut - g[-1]]) / end
        rise[:, -1] = slope * grid.width[-1]
    return np.column_stack([e, rise[0], g, rise[1]]), file.lo**2, grid.scale, grid.first


def even_pieces(file: FileTable, method: str, n: int, cut: float, unit: float):
    """Cubics (n - 1, 8) in the interval for energy and force/r, and inner cutoff^2, intervals per r^2 and number of the last one."""
    inner2 = file.lo * file.lo
    h = (cut * cut - inner2) / (n - 1)
    r2 = inner2 + (np.arange(n) + 0.5 * (method == "lookup")) * h
    r = np.sqrt(r2)
    e, force = file.sample(r, unit)
    g = force / r
    if method == "lookup":
        zero = np.zeros((n - 1, 3))
        pieces = np.column_stack([e[:-1], zero, g[:-1], zero])
    elif method == "linear":
        pieces = np.column_stack([cubic_coefficients(e, 0.0, h), cubic_coefficients(g, 0.0, h)])
    else:
        near = np.sqrt([r2[0] + SECANT * h, r2[-1] - SECANT * h])
        value = file.sample(near, unit)[1] / near
        lo, hi = (value[0] - g[0]) / (SECANT * h), (g[-1] - value[1]) / (SECANT * h)
        if file.slopes and file.r[0] == file.lo:
            lo = (file.slopes[0] * unit - g[0]) / (2.0 * r2[0])
        if file.slopes and file.r[-1] == cut:
            hi = (file.slopes[1] * unit - g[-1]) / (2.0 * r2[-1])
        pieces = np.column_stack([cubic_coefficients(e, clamped_spline(r2, e, -0.5 * g[0], -0.5 * g[-1]), h),
                                  cubic_coefficients(g, clamped_spline(r2, g, lo, hi), h)])
    return pieces, inner2, 1.0 / h, float(n - 2)


class Table(PairStyle):
    """Reads files when coefficients are given and makes the pieces when kernels are; with a keyword for a solver tables hold what that
    leaves to pairs."""

    from_files = True

    def works_with(self, settings):
        return frozenset(settings["keywords"].split()) & {"ewald", "pppm", "msm"}

    def long_cutoffs(self, use):
        return [self.cutoffs(c, use.settings)[0] for c in use.coeff.values()] if self.works_with(use.settings) else []

    def parse_settings(self, words_):
        what = "pair_style table"
        if len(words_) < 2:
            raise InputError(f"{what} needs style N [keywords], got {len(words_)} value{'s' * (len(words_) != 1)}")
        method = words.choice(words_[0], METHODS, f"{what}: style")
        n = words.whole(words_[1], f"{what}: N")
        if n < 2:
            raise InputError(f"{what}: N must be at least 2, got {n}")
        for word in words_[2:]:
            words.choice(word, KEYWORDS, f"{what}: keyword")
        return {"style": method, "N": n, "keywords": " ".join(words_[2:])}

    def format_settings(self, settings):
        return [settings["style"], str(settings["N"]), *settings["keywords"].split()]

    def parse_coeff(self, words_, settings):
        values = super().parse_coeff(words_, settings)
        what, name = "pair_coeff table", values["keyword"]
        file = FileTable(tabulated.read_section(values["file"], name, KNOWN, 4, what))
        cut = values.get("cut", file.hi)
        if not file.lo < cut <= file.hi:
            raise InputError(f"{what}: cutoff {cut:g} is outside of table {name}, which goes from {file.lo:g} to {file.hi:g}")
        if file.kind == "BITMAP" and not (settings["style"] == "bitmap" and len(file.e) == 1 << settings["N"] and cut == file.hi):
            raise InputError(f"{what}: table {name} is a bitmap of {len(file.e)} values, which needs pair_style table bitmap M with "
                             "2^M of the same size and no cutoff of its own")
        if settings["style"] == "bitmap":
            Grid(file.lo, cut, settings["N"], f"{what} {name}")
        return values | {"data": file}

    def cutoffs(self, coeff, settings):
        return [coeff.get("cut", coeff["data"].hi)]

    def reset_cutoffs(self, coeffs):
        return {}

    def variant(self, settings, compat=""):
        return bitmap if settings["style"] == "bitmap" else self

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        rows = np.zeros((6, ntypes + 1, ntypes + 1))
        places: dict[tuple, tuple] = {}
        pieces: list[np.ndarray] = []
        for (i, j), c in filled.items():
            file, cut = c["data"], self.cutoffs(c, settings)[0]
            key = (file.section.file, file.section.keyword, id(file), cut)
            if key not in places:
                unit = unit_factor(file.section, units)
                if settings["style"] == "bitmap":
                    made, *numbers = bitmap_pieces(file, settings["N"], cut, unit, f"pair table {file.section.keyword}")
                else:
                    made, *numbers = even_pieces(file, settings["style"], settings["N"], cut, unit)
                places[key] = (float(len(pieces)), *numbers)
                pieces.append(made)
            rows[:, i, j] = rows[:, j, i] = [cut * cut, 0.0, *places[key]]
        return PairTables(rows, np.zeros(0), (np.stack(pieces) if pieces else np.zeros((1, 1, 8)),))


def unit_factor(section: tabulated.Section, units) -> float:
    """Factor from the energies of a file that names its unit style to those of the scene."""
    if not section.units or units is None or section.units == units.name:
        return 1.0
    if (section.units, units.name) == ("metal", "ase"):
        return 1.0
    if (section.units, units.name) not in CONVERT:
        raise InputError(f"pair table {section.keyword} requires {section.units} units but {units.name} units are in use", section.where)
    return CONVERT[section.units, units.name]


OPTIONS = dict(settings="style N [keywords]", coeff="file keyword [cut]",
               units=dict(file="path", keyword="word", style="word", keywords="word"),
               domain="the distance is below the inner end of the table",
               settings_example="linear 1000", example="file KEYWORD 2.5",
               doc=__doc__, see="LAMMPS manual, pair_style table")
style = register(Table("table", [(table, "cut")], rows="index inner2 scale last", **OPTIONS))
bitmap = Table("table", [(table_bitmap, "cut")], rows="index inner2 scale first", **OPTIONS)
