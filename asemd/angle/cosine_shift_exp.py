r"""$$E = -U_{min} \frac{e^{-a U} - 1}{e^a - 1}, \quad U = -\tfrac{1}{2} [1 + \cos(\theta - \theta_0)]$$

Bounded between -Umin, at theta0, and zero; a sets the stiffness at theta0, and a = 0 is cosine/shift.
As in LAMMPS the formula is expanded to first order in a where |a| < 0.001.
Source: LAMMPS manual, angle_style cosine/shift/exp.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_shift_exp_d2(theta, Umin, theta0, a):
    d = theta - theta0
    c, s = math.cos(0.5 * d), math.sin(0.5 * d)
    u, first, second = c * c, -s * c, -0.5 * math.cos(d)       # (1 + cos(d)) / 2 and its derivatives
    if abs(a) < 0.001:
        return -Umin * (second * (1.0 + a * (u - 0.5)) + a * first * first)
    weight = -math.exp(-a * s * s) / math.expm1(-a) if a > 0.0 else math.exp(a * u) / math.expm1(a)
    return -Umin * a * weight * (second + a * first * first)


@angle("cosine/shift/exp", example="10.0 45.0 2.0", equilibrium="theta0", d2=cosine_shift_exp_d2)
def cosine_shift_exp(theta, Umin: "energy", theta0: "angle", a):
    d = theta - theta0
    c, s = math.cos(0.5 * d), math.sin(0.5 * d)
    half = 0.5 * Umin * math.sin(d)
    if abs(a) < 0.001:       # LAMMPS's expansion, to first order in a
        return -Umin * c * c * (1.0 - 0.5 * a * s * s), half * (1.0 + a * (c * c - 0.5))
    if a > 0.0:        # numerator and denominator times exp(-a): no overflow
        x = math.exp(-a * s * s)
        return -Umin * x * math.expm1(-a * c * c) / math.expm1(-a), -half * a * x / math.expm1(-a)
    return -Umin * math.expm1(a * c * c) / math.expm1(a), half * a * math.exp(a * c * c) / math.expm1(a)
