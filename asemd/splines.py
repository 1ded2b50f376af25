"""Cubic polynomials between equidistant values, as LAMMPS makes them of the tables of embedded-atom potentials."""
from __future__ import annotations

import numpy as np


def polynomials(values: np.ndarray, flat: bool = False) -> np.ndarray:
    """Coefficients (..., n - 1, 4) of t^3, t^2, t, 1 in each interval of `values (..., n)`, t from 0 to 1.

    Slopes in the values come from four neighbours, from two next to the ends and from one at the ends; with
    `flat` the last one is 0.
    """
    f = np.asarray(values, float)
    slope = np.empty_like(f)
    slope[..., 0] = f[..., 1] - f[..., 0]
    slope[..., 1] = 0.5 * (f[..., 2] - f[..., 0])
    slope[..., -2] = 0.5 * (f[..., -1] - f[..., -3])
    slope[..., -1] = 0.0 if flat else f[..., -1] - f[..., -2]
    slope[..., 2:-2] = ((f[..., :-4] - f[..., 4:]) + 8.0 * (f[..., 3:-1] - f[..., 1:-3])) / 12.0
    step, low, high = f[..., 1:] - f[..., :-1], slope[..., :-1], slope[..., 1:]
    return np.stack([low + high - 2.0 * step, 3.0 * step - 2.0 * low - high, low, f[..., :-1]], axis=-1)


def resampled(values: np.ndarray, spacing: float, count: int, new_spacing: float) -> np.ndarray:
    """`values` at other distances, by the cubic through four neighbours; beyond the end the last one goes on."""
    p = np.arange(count) * new_spacing / spacing + 1.0
    k = np.clip(p.astype(int), 2, len(values) - 2)
    p = np.minimum(p - k, 2.0)
    a, b, c, d = (values[k + s] for s in (-2, -1, 0, 1))
    sixth = 1.0 / 6.0
    return (-sixth * p * (p - 1.0) * (p - 2.0) * a + 0.5 * (p * p - 1.0) * (p - 2.0) * b - 0.5 * p * (p + 1.0) * (p - 2.0) * c
            + sixth * p * (p * p - 1.0) * d)
