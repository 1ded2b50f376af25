"""Slopes, exponents and errors of correlated series.

Source: H. Flyvbjerg, H. G. Petersen, J. Chem. Phys. 91, 461 (1989), for errors by blocks.
"""
from __future__ import annotations

import math

import numpy as np

FEWEST = 8              # blocks that an error may rest on


def residual(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """What remains of y above a straight line."""
    return y - np.polyval(np.polyfit(x - x[0], y, 1), x - x[0])


def slope(x: np.ndarray, y: np.ndarray, blocks: int = 10) -> tuple[float, float]:
    """Slope of a straight line through the means of blocks, and its standard error; nan for fewer than four samples."""
    if len(x) < 4:
        return math.nan, math.nan
    parts = np.array_split(np.arange(len(x)), min(blocks, len(x) // 2) if len(x) > 8 else len(x))
    a, b = (np.array([v[p].mean() for p in parts]) for v in (x, y))
    p = np.polyfit(a - a[0], b, 1)
    rest = b - np.polyval(p, a - a[0])
    return float(p[0]), float(math.sqrt((rest @ rest) / (len(a) - 2) / ((a - a.mean()) @ (a - a.mean()))))


def block_error(y) -> float:
    """Standard error of the mean of a correlated series: neighbours are averaged until the error grows no more."""
    y, best = np.asarray(y, float), math.nan
    while len(y) >= FEWEST:
        error = float(np.std(y, ddof=1)) / math.sqrt(len(y))
        if best == best and error <= best * (1.0 + 1.0 / math.sqrt(2.0 * (len(y) - 1))):
            return max(best, error)
        best = error if best != best else max(best, error)
        y = 0.5 * (y[0:len(y) // 2 * 2:2] + y[1:len(y) // 2 * 2:2])
    return best


def fit_exponent(x, y) -> tuple[float, float]:
    """Slope of log y by log x, and its standard error (nan for fewer than three points)."""
    if len(x) < 2:
        return math.nan, math.nan
    a, b = np.log(x), np.log(y)
    p = np.polyfit(a, b, 1)
    if len(x) < 3:
        return float(p[0]), math.nan
    rest = b - np.polyval(p, a)
    return float(p[0]), float(math.sqrt((rest @ rest) / (len(x) - 2) / ((a - a.mean()) @ (a - a.mean()))))
