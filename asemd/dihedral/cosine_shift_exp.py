r"""$$E = -U_{min} \frac{e^{a u} - 1}{e^a - 1} \quad \text{with} \quad u = \tfrac{1}{2} [1 + \cos(\phi - \theta)]$$

Torsion with one minimum of depth Umin at theta whose width a sets; for |a| < 0.001 it is, as in LAMMPS, the expansion to first order,
-Umin u [1 + a (u - 1) / 2]. There LAMMPS's force is not minus the gradient of its energy; ``compat="lammps"`` gives it. For three atoms
on a line u is 1/2.
Source: LAMMPS manual, dihedral_style cosine/shift/exp.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def lammps_force(phi, Umin: "energy", theta: "angle", a):
    s = math.sin(0.5 * (phi - theta))
    c = math.cos(0.5 * (phi - theta))
    u = c * c
    if abs(a) < 0.001:
        return -Umin * u * (1.0 - 0.5 * a * s * s), Umin * (s * c - 0.25 * a * (c - s) * (c + s))
    if a > 0.0:
        w = math.exp(-a * s * s)
        return -Umin * w * math.expm1(-a * u) / math.expm1(-a), -Umin * a * s * c * w / math.expm1(-a)
    return -Umin * math.expm1(a * u) / math.expm1(a), Umin * a * s * c * math.exp(a * u) / math.expm1(a)


def on_line(Umin, theta, a):          # u = 1/2
    return -0.5 * Umin * (1.0 - 0.25 * a) if abs(a) < 0.001 else -Umin / (1.0 + math.exp(0.5 * a))


def cosine_shift_exp_d2(phi, Umin, theta, a):
    d = phi - theta
    c, s = math.cos(0.5 * d), math.sin(0.5 * d)
    u, first, second = c * c, -s * c, -0.5 * math.cos(d)       # (1 + cos(d)) / 2 and its derivatives
    if abs(a) < 0.001:
        return -Umin * (second * (1.0 + a * (u - 0.5)) + a * first * first)
    weight = -math.exp(-a * s * s) / math.expm1(-a) if a > 0.0 else math.exp(a * u) / math.expm1(a)
    return -Umin * a * weight * (second + a * first * first)


@dihedral("cosine/shift/exp", example="10.0 45.0 2.0", lammps=lammps_force, straight=on_line, d2=cosine_shift_exp_d2)
def cosine_shift_exp(phi, Umin: "energy", theta: "angle", a):
    s = math.sin(0.5 * (phi - theta))
    c = math.cos(0.5 * (phi - theta))
    u = c * c
    if abs(a) < 0.001:
        return -Umin * u * (1.0 - 0.5 * a * s * s), Umin * s * c * (1.0 + 0.5 * a * (c - s) * (c + s))
    if a > 0.0:                       # divided by exp(a), which may overflow
        w = math.exp(-a * s * s)
        return -Umin * w * math.expm1(-a * u) / math.expm1(-a), -Umin * a * s * c * w / math.expm1(-a)
    return -Umin * math.expm1(a * u) / math.expm1(a), Umin * a * s * c * math.exp(a * u) / math.expm1(a)
