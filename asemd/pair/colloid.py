r"""Colloid spheres made of Lennard-Jones matter, and solvent: formulas for two spheres, for a sphere and a particle, for two particles.

Two spheres of radii a1 and a2, with s = a1 + a2 and d = a1 - a2:

$$U = -\frac{A}{6} \left[ \frac{2 a_1 a_2}{r^2 - s^2} + \frac{2 a_1 a_2}{r^2 - d^2} + \ln \frac{r^2 - s^2}{r^2 - d^2} \right]
    + \frac{A \sigma^6}{37800\, r} \sum_{k=1}^{4} \pm \frac{r^2 + 7 r k_i + 6 n_i}{(r + k_i)^7}$$

a sphere of radius a and a particle, and two particles:

$$U = \frac{2 a^3 \sigma^3 A}{9 (a^2 - r^2)^3}
    \left[ 1 - \frac{(5 a^6 + 45 a^4 r^2 + 63 a^2 r^4 + 15 r^6) \sigma^6}{15 (a^2 - r^2)^6} \right],
    \qquad U = \frac{A}{36} \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right]$$

d1 and d2 are diameters, 0 for solvent.  Everaers and Ejtehadi, Phys. Rev. E 67, 041710 (2003).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.lj_cut import lj_cut
from asemd.pairstyle import PairStyle, pair_sum


def spheres(r, A: "energy", sigma: "distance", a1: "distance", a2: "distance"):
    s, d, k = a1 + a2, a1 - a2, a1 * a2
    squares = 6.0 * (a1 * a1 + a2 * a2)
    p, q = (r - s) * (r + s), (r - d) * (r + d)
    apart = r > s
    e = -0.16666666666666666 * A * (2.0 * k / p + 2.0 * k / q + math.log(p / q if apart else 1.0))
    gap = 4.0 * k / (p * q)
    slope = 0.6666666666666666 * A * k * gap * gap * r
    u, v, w, x = 1.0 / (r - s), 1.0 / (r + s), 1.0 / (r + d), 1.0 / (r - d)
    near, far = squares + 42.0 * k, squares - 42.0 * k
    n1 = r * (r - 7.0 * s) + near
    n2 = r * (r + 7.0 * s) + near
    n3 = r * (r + 7.0 * d) + far
    n4 = r * (r - 7.0 * d) + far
    u7, v7, w7, x7 = u * u * u * u * u * u * u, v * v * v * v * v * v * v, w * w * w * w * w * w * w, x * x * x * x * x * x * x
    total = n1 * u7 + n2 * v7 - n3 * w7 - n4 * x7
    change = ((2.0 * r - 7.0 * s - 7.0 * n1 * u) * u7 + (2.0 * r + 7.0 * s - 7.0 * n2 * v) * v7
              - (2.0 * r + 7.0 * d - 7.0 * n3 * w) * w7 - (2.0 * r - 7.0 * d - 7.0 * n4 * x) * x7)
    s2 = sigma * sigma
    front = A * s2 * s2 * s2 / (37800.0 * r)
    return (e + front * total if apart else 1e999), (slope + front * (change - total / r) if apart else 1e999)      # infinite


def solvated(r2, A: "energy", sigma: "distance", radius: "distance"):
    a2 = radius * radius
    r = math.sqrt(r2)
    w = 1.0 / ((radius - r) * (radius + r))
    w3 = w * w * w
    s2 = sigma * sigma
    s6 = 0.06666666666666667 * s2 * s2 * s2
    front = 0.2222222222222222 * A * a2 * radius * s2 * sigma * w3
    p = a2 * a2 * (5.0 * a2 + 45.0 * r2) + r2 * r2 * (63.0 * a2 + 15.0 * r2)
    slope = 45.0 * a2 * a2 + r2 * (126.0 * a2 + 45.0 * r2)
    x = s6 * w3 * w3
    apart = r > radius
    return (front * (1.0 - p * x) if apart else 1e999), (front * (3.0 * w - x * (slope + 9.0 * p * w)) if apart else 1e999)


def spheres_d2(r, A, sigma, a1, a2):
    s, d, k = a1 + a2, a1 - a2, a1 * a2
    if r <= s:
        return math.inf
    squares, p, q = 6.0 * (a1 * a1 + a2 * a2), (r - s) * (r + s), (r - d) * (r + d)
    gap = 4.0 * k / (p * q)
    total = change = bend = 0.0
    for m in range(4):      # the four powers of the sum: distance, sign, and the polynomial with its slope
        t = -s if m == 0 else s if m == 1 else d if m == 2 else -d
        sign = 1.0 if m < 2 else -1.0
        u = 1.0 / (r + t)
        n, slope = r * (r + 7.0 * t) + squares + sign * 42.0 * k, 2.0 * r + 7.0 * t
        u7 = sign * u**7
        total += n * u7
        change += (slope - 7.0 * n * u) * u7
        bend += (2.0 - 14.0 * slope * u + 56.0 * n * u * u) * u7
    attraction = 0.6666666666666666 * A * k * gap * gap * (1.0 - 4.0 * r * r * (1.0 / p + 1.0 / q))
    return attraction + A * sigma**6 / (37800.0 * r) * (bend - 2.0 * change / r + 2.0 * total / (r * r))


def solvated_d2(r2, A, sigma, radius):
    a2 = radius * radius
    if r2 <= a2:
        return math.inf
    w = 1.0 / (a2 - r2)
    front = 0.2222222222222222 * A * (radius * sigma) ** 3 * w**3
    p = a2 * a2 * (5.0 * a2 + 45.0 * r2) + r2 * r2 * (63.0 * a2 + 15.0 * r2)
    slope, bend = 45.0 * a2 * a2 + r2 * (126.0 * a2 + 45.0 * r2), 126.0 * a2 + 90.0 * r2
    return front * (12.0 * w * w - 0.06666666666666667 * (sigma * w) ** 6 * (bend + 18.0 * w * slope + 90.0 * w * w * p))


spheres.d2, solvated.d2 = spheres_d2, solvated_d2


class ColloidPair(PairStyle):
    """Says which of the three formulas a pair of types has."""

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if min(values["d1"], values["d2"]) < 0.0:
            raise InputError(f"pair_coeff colloid: d1 and d2 must not be negative, got {values['d1']:g} and {values['d2']:g}")
        return values

    def cutoffs(self, coeff, settings):
        large = (coeff["d1"] > 0.0) + (coeff["d2"] > 0.0)
        cut = coeff.get("cut", settings.get("cut", 0.0))
        return [cut if large == k else 0.0 for k in (2, 1, 0)]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        full = {}
        for (i, j), c in filled.items():
            if i == j and c["d1"] != c["d2"]:
                raise InputError(f"pair_coeff {i} {j} colloid: d1 and d2 of one type must be equal, got {c['d1']:g} and {c['d2']:g}")
            full[i, j] = {**c, "a1": 0.5 * c["d1"], "a2": 0.5 * c["d2"], "radius": 0.5 * max(c["d1"], c["d2"]), "epsilon": c["A"] / 144.0}
        return super().pack_pairs(settings, full, ntypes, units, shift)


pair_sum("colloid", (spheres, "cut"), (solvated, "cut"), (lj_cut, "cut"), settings="cut", coeff="A sigma d1 d2 [cut]", cls=ColloidPair,
         mix={"A": "sigma", "sigma": "distance", "d1": "distance", "d2": "distance"}, rows="a1 a2 radius epsilon",
         units={"d1": "distance", "d2": "distance"}, domain="the particles overlap", settings_example="5.0",
         example="39.5 1.0 2.0 2.0 4.5", see="LAMMPS manual, pair_style colloid")
