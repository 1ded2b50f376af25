r"""Tables of the smooth SO(3) power spectrum: how much a neighbour at a distance adds to the coefficients of a density.

Neighbours are Gaussians $e^{-\alpha|\mathbf r-\mathbf r_k|^2}$ with weights $w_kf_c(r_k)$; the coefficients of their sum are [1]_

$$c_{nlm}=\sum_kw_k\,Q_{nl}(r_k^2)\,r_k^lY_{lm}(\hat{\mathbf r}_k),\quad
Q_{nl}(s)=4\pi f_c\,e^{-\alpha s}s^{-l/2}\int_0^{r_c}r^2g_n(r)\,e^{-\alpha r^2}\,i_l(2\alpha r\sqrt s)\,dr$$

with modified spherical Bessel functions i and orthonormal polynomials g, and the components of the spectrum are
$p_{nn'l}=2\sqrt2\,\pi(2l+1)^{-1/2}\sum_mc_{nlm}c_{n'lm}$. Q is smooth in s, so that it comes from a table without loss of digits, and
$r^lY_{lm}$ is a polynomial: nothing is singular where a neighbour is on an axis or on the atom.

.. [1] Zagaceta, Yanxon and Zhu, J. Appl. Phys. 128, 045113 (2020)
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import factorial

import numpy as np

DEGREE = 5                 # of the polynomials of the table, which meet with equal first and second derivatives
FINENESS = 36.0            # intervals of s for each unit in exponents and cosines: the polynomials are as exact as what they stand for


@dataclass(frozen=True)
class PowerSpectrum:
    """Tables of all components.

    Attributes
    ----------
    pairs (nmax (nmax + 1) / 2, 2)
        n and n' of each group of lmax + 1 components.
    strengths ((lmax + 1)^2,)
        Factor of the squares of coefficients by solid harmonics that are not normalised; that of l, m at l (l + 1) + m.
    radial (intervals, DEGREE + 1, nmax (lmax + 1))
        Q as polynomials in the place within an interval, 0 to 1, the highest power first.
    per_interval : float
        Intervals of the table for each unit of s.
    """

    pairs: np.ndarray
    strengths: np.ndarray
    radial: np.ndarray
    per_interval: float

    @property
    def count(self) -> int:
        """Number of components."""
        return len(self.pairs) * int(round(len(self.strengths) ** 0.5))


def basis(nmax: int, cut: float, r: np.ndarray) -> np.ndarray:
    """The orthonormal functions g (nmax, len(r)): combinations of (cut - r)^(n + 2), n = 1, 2, ..., as symmetric as can be."""
    n = np.arange(1.0, nmax + 1)
    norm = (2 * n + 5) * (2 * n + 6) * (2 * n + 7)
    mixed = n[:, None] + n
    overlap = np.sqrt(np.outer(norm, norm)) / ((5 + mixed) * (6 + mixed) * (7 + mixed))
    values, vectors = np.linalg.eigh(overlap)
    return (vectors / np.sqrt(values)) @ vectors.T @ ((cut - r) ** (n[:, None] + 2) / np.sqrt(2.0 * cut ** (2 * n + 7) / norm)[:, None])


def bessel(order: int, x: np.ndarray) -> np.ndarray:
    """i_l(x) x^-l e^-x."""
    from scipy.special import ive
    small = x < 0.1
    far = np.where(small, 1.0, x)
    out = np.sqrt(0.5 * np.pi / far) * ive(order + 0.5, far) * far ** -float(order)
    total = term = np.full_like(x, 1.0 / np.prod(np.arange(1.0, 2 * order + 2, 2)))
    for k in range(1, 6):
        term = term * x * x / (2 * k * (2 * order + 2 * k + 1))
        total = total + term
    return np.where(small, total * np.exp(-x), out)


@cache
def power_spectrum(nmax: int, lmax: int, alpha: float, cut: float) -> PowerSpectrum:
    """The tables.

    Parameters
    ----------
    nmax, lmax : int
        Number of radial functions, largest l.
    alpha : float
        Inverse square width of a neighbour, 1/distance^2.
    cut : float
        Radius of the density.
    """
    points = 10 * (nmax + lmax + 1)      # of the Chebyshev-Gauss rule, as in LAMMPS: potentials are fitted with this sum
    x = np.cos((2.0 * np.arange(1, points + 1) - 1.0) * np.pi / (2 * points))
    r = 0.5 * cut * (x + 1.0)
    weighted = basis(nmax, cut, r) * r * r * np.sqrt(1.0 - x * x) * (np.pi / points * 0.5 * cut)
    intervals = int(np.ceil(FINENESS * (alpha * cut * cut + np.pi**2)))
    s = np.linspace(0.0, cut * cut, intervals + 1)
    d, arm = np.sqrt(s), 2.0 * alpha * r
    gauss = np.exp(-alpha * (d[:, None] - r) ** 2)
    w = np.pi / cut
    taper = np.array([0.5 * np.cos(w * d) + 0.5, -0.25 * w * w * np.sinc(d / cut), np.zeros_like(s)])
    with np.errstate(divide="ignore", invalid="ignore"):      # second derivative of a cosine of a root, 1/24 w^4 at zero
        taper[2] = np.where(s > 1e-4 * cut * cut, 0.125 * w * (np.sin(w * d) / d - w * np.cos(w * d)) / s,
                            w**4 / 24.0 * (1.0 - w * w * s / 10.0 + (w * w * s) ** 2 / 280.0))
    values = np.empty((3, intervals + 1, nmax, lmax + 1))      # Q and its derivatives by s
    for order in range(lmax + 1):
        # each derivative of i_l(a d) d^-l by s raises l by one
        raw = [4.0 * np.pi * (gauss * bessel(order + k, d[:, None] * arm) * arm**order * (0.5 * arm * arm) ** k) @ weighted.T
               for k in range(3)]
        smooth = [raw[0], raw[1] - alpha * raw[0], raw[2] - 2.0 * alpha * raw[1] + alpha * alpha * raw[0]]
        t = taper[:, :, None]
        values[:, :, :, order] = [t[0] * smooth[0], t[1] * smooth[0] + t[0] * smooth[1],
                                  t[2] * smooth[0] + 2.0 * t[1] * smooth[1] + t[0] * smooth[2]]
    return PowerSpectrum(np.array([(n, k) for n in range(nmax) for k in range(n + 1)]), strengths(lmax),
                         polynomials(values.reshape(3, intervals + 1, -1), s[1]), intervals / (cut * cut))


def polynomials(values: np.ndarray, step: float) -> np.ndarray:
    """Polynomials of degree 5 (intervals, 6, n), highest power first, with given values and two derivatives (3, intervals + 1, n)."""
    f, g, h = values[0], step * values[1], 0.5 * step * step * values[2]
    rise = f[1:] - f[:-1] - g[:-1] - h[:-1]
    slope, bend = g[1:] - g[:-1] - 2.0 * h[:-1], h[1:] - h[:-1]
    return np.ascontiguousarray(np.stack([6 * rise - 3 * slope + bend, -15 * rise + 7 * slope - 2 * bend, 10 * rise - 4 * slope + bend,
                                          h[:-1], g[:-1], f[:-1]], axis=1))


def strengths(lmax: int) -> np.ndarray:
    """Factors of the squares of coefficients by solid harmonics without norm: real and imaginary part of (x + iy)^m times a derivative of
    a Legendre polynomial."""
    out = np.empty((lmax + 1) ** 2)
    for l in range(lmax + 1):
        for m in range(-l, l + 1):
            norm = (2 * l + 1) / (4.0 * np.pi) * factorial(l - abs(m)) / factorial(l + abs(m)) * (1.0 if m == 0 else 2.0)
            out[l * (l + 1) + m] = 2.0 * np.sqrt(2.0) * np.pi / np.sqrt(2.0 * l + 1.0) * norm
    return out
