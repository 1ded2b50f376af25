"""Bonded styles that are read from a table file, and the lookup that compiled code makes.

As in LAMMPS a file is interpolated twice: splines through its values fill an inner table of evenly spaced nodes, and the inner table is
read during a run, linearly or by cubic splines. Energy and force are interpolated apart, so the force is minus the slope of the energy
only as far as the file's force is.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, Where
from asemd.style import Packed, Parameter, Style
from asemd.tabulated import Section, clamped_spline, read_section, spline_value

INTERPOLATED = dict.fromkeys(("slope", "gradient", "virial"), "energy and force are interpolated apart")


def _solve(lower, diagonal, upper, right):
    """Tridiagonal system, `right` (n, k); rows are diagonally dominant, so no pivoting."""
    n = len(diagonal)
    c, x = np.array(upper, float), np.array(right, float)
    pivot = diagonal[0]
    x[0] /= pivot
    for i in range(1, n):
        c[i - 1] /= pivot
        pivot = diagonal[i] - lower[i] * c[i - 1]
        x[i] = (x[i] - lower[i] * x[i - 1]) / pivot
    for i in range(n - 2, -1, -1):
        x[i] -= c[i] * x[i + 1]
    return x


def periodic_spline(x: np.ndarray, y: np.ndarray, period: float) -> np.ndarray:
    """Second derivatives at the nodes of the cubic spline that repeats after `period`.

    Parameters
    ----------
    x, y : (n,)
        Nodes, x increasing within one period, n at least 2.
    """
    n = len(x)
    h = np.diff(np.append(x, x[0] + period))
    d = np.diff(np.append(y, y[0])) / h
    right, before = d - np.roll(d, 1), np.roll(h, 1)
    if n < 3:
        matrix = np.zeros((n, n))
        for i in range(n):
            matrix[i, i] += (h[i] + before[i]) / 3.0
            matrix[i, (i + 1) % n] += h[i] / 6.0
            matrix[i, i - 1] += before[i] / 6.0
        return np.linalg.solve(matrix, right)
    # the two corners of the cyclic matrix are a change of rank one (Sherman and Morrison)
    diagonal, corner = (h + before) / 3.0, h[-1] / 6.0
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[-1] -= corner * corner / gamma
    u = np.zeros(n)
    u[0], u[-1] = gamma, corner
    z = _solve(before / 6.0, diagonal, h / 6.0, np.column_stack([right, u]))
    factor = (z[0, 0] + corner / gamma * z[-1, 0]) / (1.0 + z[0, 1] + corner / gamma * z[-1, 1])
    return z[:, 0] - factor * z[:, 1]


def spline_slope(x: np.ndarray, y: np.ndarray, second: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Slope at the points `at` of the cubic spline with nodes (x, y) and second derivatives `second`."""
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = x[k + 1] - x[k]
    a, b = (x[k + 1] - at) / h, (at - x[k]) / h
    return (y[k + 1] - y[k]) / h + ((3.0 * b * b - 1.0) * second[k + 1] - (3.0 * a * a - 1.0) * second[k]) * h / 6.0


def interpolate(x, lo, delta, first, rows, mode, nodes):
    """Energy and slope from the inner table: `rows` rows of `nodes` from `first`; columns energy, force and their second derivatives.

    `mode` 0: linear, 1: splines of energy and force, 2: spline of the energy and its slope.
    """
    k = min(int((x - lo) / delta), int(rows) - 2)
    b = (x - (lo + k * delta)) / delta
    a = 1.0 - b
    k += int(first)
    e0, e1, f0, f1 = nodes[k, 0], nodes[k + 1, 0], nodes[k, 1], nodes[k + 1, 1]
    if mode == 0.0:
        return e0 + b * (e1 - e0), -(f0 + b * (f1 - f0))
    p, q, s = (a * a * a - a), (b * b * b - b), delta * delta / 6.0
    e = a * e0 + b * e1 + (p * nodes[k, 2] + q * nodes[k + 1, 2]) * s
    if mode == 1.0:
        return e, -(a * f0 + b * f1 + (p * nodes[k, 3] + q * nodes[k + 1, 3]) * s)
    return e, (e1 - e0) / delta + ((3.0 * b * b - 1.0) * nodes[k + 1, 2] - (3.0 * a * a - 1.0) * nodes[k, 2]) * delta / 6.0


def inner_table(table, n: int, spline: bool) -> tuple[float, float, float, np.ndarray]:
    """First node, last node, spacing and nodes (n, 4) of the inner table for x, energy, force and slopes of the force at the ends."""
    x, e, f, first, last = table
    delta = (x[-1] - x[0]) / (n - 1)
    r = x[0] + np.arange(n) * delta
    nodes = np.zeros((n, 4))
    nodes[:, 0] = spline_value(x, e, clamped_spline(x, e, -f[0], -f[-1]), r)
    nodes[:, 1] = spline_value(x, f, clamped_spline(x, f, first, last), r)
    if spline:
        nodes[:, 2] = clamped_spline(r, nodes[:, 0], -nodes[0, 1], -nodes[-1, 1])
        nodes[:, 3] = clamped_spline(r, nodes[:, 1], first, last)
    return float(x[0]), float(x[-1]), float(delta), nodes


class TableStyle(Style):
    """``*_style table linear|spline N`` with coefficients ``file keyword``; the function takes `ROWS` and the array of nodes.

    The table is read when the coefficients are given, so a later change of folder or file does not matter; it travels as ``table``
    (x, energy, force, slopes of the force at both ends) beside the words.
    """

    ROWS = ("lo", "hi", "delta", "first", "rows", "mode")
    smallest = 2

    coeff_before: tuple[Parameter, ...] = ()      # further words before the file, each an argument of the function

    def __init__(self, category, name, function, *, example="file KEYWORD", **options):
        super().__init__(category, name, function, coeff=(*self.coeff_before, Parameter("file", "path"), Parameter("keyword", "word")),
                         settings=(Parameter("style", "word"), Parameter("N", "integer")), settings_example="spline 100",
                         example=example, **options)

    def functions(self):
        return interpolate, self.function

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if values["style"] not in ("linear", "spline"):
            raise InputError(f"{self.category}_style {self.name}: unknown table style {values['style']}, must be linear or spline")
        if values["N"] < self.smallest:
            raise InputError(f"{self.category}_style {self.name}: illegal number of table entries {values['N']}, "
                             f"must be {self.smallest} or more")
        return values

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        return {**values, **self.read(values["file"], values["keyword"], settings)}

    def section(self, path: str, keyword: str, known: dict, columns: int, texts=()) -> Section:
        """One section of the file, in which the first values increase from line to line."""
        section = read_section(path, keyword, {"N": 1, **known}, columns, f"{self.category}_coeff {self.name}", texts)
        section.check_increasing(section.columns[:, 1], f"{self.category}_coeff {self.name}")
        return section

    def wrong(self, section: Section, message: str) -> InputError:
        return InputError(f"{self.category}_coeff {self.name}: {message}: section {section.keyword} of {section.file}", section.where)

    def read(self, path: str, keyword: str, settings) -> dict:
        """What a section of a table file says, as further coefficients: ``table``, ``units`` it names, the rest length or angle."""
        section = self.section(path, keyword, {"FP": 2, "EQ": 1}, 4)
        x, e, f = section.columns[:, 1:].T
        section.check_slopes(x, e, f, f"{self.category}_coeff {self.name}")
        ends = section.parameters.get("FP") or ((f[1] - f[0]) / (x[1] - x[0]), (f[-1] - f[-2]) / (x[-1] - x[-2]))
        return {"units": section.units, **self.finish(section, x, e, f, ends, section.parameters.get("EQ", (None,))[0])}

    def finish(self, section, x, e, f, ends, rest) -> dict:
        """The coefficients for values in the file's units; overridden for angles."""
        return {"table": (x, e, f, *ends), self.equilibrium: float(x[np.argmin(e)]) if rest is None else rest}

    def inner(self, table, settings) -> tuple[float, float, float, np.ndarray]:
        """See `inner_table`; overridden for periodic coordinates."""
        return inner_table(table, settings["N"], settings["style"] == "spline")

    def pack(self, settings, coeffs, ntypes, units):
        own = [p for p in self.coeff_before if p.name in self.arguments]
        coeff, parts, start = np.zeros((len(self.ROWS) + len(own), ntypes + 1)), [], 0
        for t, values in coeffs.items():
            values = values if "table" in values else {**values, **self.read(values["file"], values["keyword"], settings)}
            named = values["units"]
            if named and units is not None and named != units.name and (named, units.name) != ("metal", "ase"):
                raise InputError(f"{self.category}_coeff {self.name}: {values['file']} requires {named} units but {units.name} units "
                                 "are in use", Where(values["file"], 1))
            lo, hi, delta, nodes = self.inner(values["table"], settings)
            words = [math.radians(values[p.name]) if p.unit == "angle" else values[p.name] for p in own]
            coeff[:, t] = lo, hi, delta, start, len(nodes), self.mode(settings, values), *words
            parts.append(nodes)
            start += len(nodes)
        return Packed(coeff, (np.concatenate(parts) if parts else np.zeros((1, 4)),))

    def mode(self, settings, values) -> float:
        return 1.0 if settings["style"] == "spline" else 0.0
