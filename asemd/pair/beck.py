r"""$$E = A e^{-\alpha r - \beta r^6} - \frac{B}{(r^2 + a^2)^3} \left( 1 + \frac{2.709 + 3 a^2}{r^2 + a^2} \right) \qquad r < r_c$$

Helium at high pressure.  Beck, Mol. Phys. 14, 311 (1968).
"""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def beck_d2(r, A, B, a, alpha, beta):
    x = 1.0 / (r * r + a * a)
    x4, k, r4 = x * x * x * x, 2.709 + 3.0 * a * a, r * r * r * r
    slope = alpha + 6.0 * beta * r4 * r
    repulsion = A * math.exp(-r * (alpha + beta * r4 * r))
    return repulsion * (slope * slope - 30.0 * beta * r4) + B * x4 * (6.0 + 8.0 * k * x - r * r * x * (48.0 + 80.0 * k * x))


@pair("beck", settings="cut", coeff="A B a alpha beta [cut]", settings_example="8.0", d2=beck_d2, shifts=False,
      example="399.671876712 0.0000867636112694 0.675 4.390 0.0003746 6.0", see="LAMMPS manual, pair_style beck")
def beck(r, A: "energy", B: "energy*distance^6", a: "distance", alpha: "1/distance", beta: "1/distance^6"):
    r2 = r * r
    x = 1.0 / (r2 + a * a)
    attraction = B * x * x * x
    k = (2.709 + 3.0 * a * a) * x
    r5 = r2 * r2 * r
    repulsion = A * math.exp(-r * (alpha + beta * r5))
    return repulsion - attraction * (1.0 + k), attraction * r * x * (6.0 + 8.0 * k) - repulsion * (alpha + 6.0 * beta * r5)
