"""The smooth SO(3) power spectrum: tables against the integrals they stand for, and neighbours where angles are singular."""
from __future__ import annotations

import mpmath
import numpy as np
import pytest

from asemd.kernels.power_spectrum import harmonic_slope, solid_harmonics
from asemd.power_spectrum import basis, power_spectrum, strengths


def radial(tables, s: float) -> tuple[np.ndarray, np.ndarray]:
    """Q and its derivative by s."""
    u = s * tables.per_interval
    k = min(int(u), len(tables.radial) - 1)
    powers = (u - k) ** np.arange(5, -1, -1)
    slopes = np.append(np.arange(5, 0, -1) * powers[1:], 0.0)
    return powers @ tables.radial[k], slopes @ tables.radial[k] * tables.per_interval


@pytest.mark.parametrize(("nmax", "lmax", "alpha", "cut"), [(3, 4, 2.0, 5.0), (2, 2, 0.3, 3.0), (1, 5, 6.0, 6.0)])
def test_tables_are_the_sums_over_the_radius(nmax, lmax, alpha, cut):
    tables = power_spectrum(nmax, lmax, alpha, cut)
    points = 10 * (nmax + lmax + 1)
    x = np.cos((2.0 * np.arange(1, points + 1) - 1.0) * np.pi / (2 * points))
    r = 0.5 * cut * (x + 1.0)
    weighted = basis(nmax, cut, r) * r * r * np.sqrt(1.0 - x * x) * (np.pi / points * 0.5 * cut)

    def exact(s, order):
        """Each term in many digits, also where the series in s must take the place of Bessel functions."""
        with mpmath.workdps(40):
            d, total = mpmath.sqrt(s), [mpmath.mpf(0)] * nmax
            for a, row in zip(r, weighted.T):
                z = 2 * alpha * mpmath.mpf(a)
                bessel = mpmath.sqrt(mpmath.pi / (2 * z * d)) * mpmath.besseli(order + 0.5, z * d) / d**order
                for n in range(nmax):
                    total[n] += mpmath.mpf(row[n]) * mpmath.exp(-alpha * (s + mpmath.mpf(a) ** 2)) * bessel
            return [4 * mpmath.pi * (0.5 * mpmath.cos(mpmath.pi * d / cut) + 0.5) * v for v in total]

    scale = np.abs(tables.radial[:, 5]).max(axis=0).reshape(nmax, lmax + 1)
    for s in (1e-6, 0.11, 0.37 * cut**2, 0.93 * cut**2):
        value, slope = (v.reshape(nmax, lmax + 1) for v in radial(tables, s))
        for order in (0, 1, lmax):
            want = exact(mpmath.mpf(s), order)
            with mpmath.workdps(40):
                step = mpmath.mpf(10) ** -12
                up, down = exact(s + step * s, order), exact(s - step * s, order)
                change = [float((a - b) / (2 * step * s)) for a, b in zip(up, down)]
            for n in range(nmax):
                assert abs(value[n, order] - float(want[n])) < 3e-14 * scale[n, order]
                assert abs(slope[n, order] - change[n]) < 2e-12 * alpha * scale[n, order]


def test_radial_functions_are_orthonormal():
    r, w = np.polynomial.legendre.leggauss(40)
    r, w = 2.2 * (r + 1.0), 2.2 * w
    g = basis(4, 4.4, r)
    assert np.abs((g * w * r * r) @ g.T - np.eye(4)).max() < 1e-9


@pytest.mark.parametrize("place", [(0.3, -0.4, 1.2), (0.0, 0.0, 1.5), (0.0, 0.0, -0.7), (0.2, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_solid_harmonics(place):
    """Their squares add up to what the addition theorem says, and slopes are derivatives, on axes and at the centre too."""
    lmax = 5
    room = np.zeros((lmax + 1) ** 2)

    def at(x):
        solid_harmonics(*x, lmax, room, 0)
        return room.copy()

    mine, x, weights = at(place), np.array(place), strengths(lmax)
    for l in range(lmax + 1):
        part = slice(l * l, (l + 1) ** 2)
        total = 2.0 * np.sqrt(2.0) * np.pi / np.sqrt(2 * l + 1) * (2 * l + 1) / (4 * np.pi) * (x @ x) ** l
        assert mine[part] ** 2 @ weights[part] == pytest.approx(total, rel=1e-13, abs=1e-300)
    numeric = np.array([(at(x + e) - at(x - e)) / 2e-5 for e in 1e-5 * np.eye(3)])
    at(place)
    for l in range(1, lmax + 1):
        for m in range(-l, l + 1):
            assert np.allclose(harmonic_slope(room, 0, l, m), numeric[:, l * (l + 1) + m], rtol=1e-7, atol=1e-6)
