r"""$$E = \sum_{i=1}^{n} C_i \, [u_i - \cos(K_i (\phi - a_i))] \, [v_i - \cos(L_i (\theta_1 - b_i))] \, [w_i - \cos(M_i (\theta_2 - c_i))]$$

Products of functions of the torsion and of both bond angles (theta1 is the angle 1-2-3, theta2 the angle 2-3-4), which place atom 4 on a
sphere around atom 3. The pressure differs from LAMMPS's, whose virial of this style has the wrong sign in the part of the bond 1-2.
Source: LAMMPS manual, dihedral_style spherical.
"""
from __future__ import annotations

import math

from asemd.series import SeriesStyle
from asemd.style import Parameter, dihedral

TERM = (Parameter("C", "energy"), Parameter("K"), Parameter("a", "angle"), Parameter("u"), Parameter("L"), Parameter("b", "angle"),
        Parameter("v"), Parameter("M"), Parameter("c", "angle"), Parameter("w"))
EXAMPLE = "2 69.3 1 93.9 1 1 90 0 1 90 0 49.1 0 0.0 0 1 74.4 1 0 0.0 0"


def factor(u, x):
    """u - cos(x) without loss of digits where u is 1 or -1."""
    if u > 0.5:
        h = math.sin(0.5 * x)
        return (u - 1.0) + 2.0 * h * h
    if u < -0.5:
        h = math.cos(0.5 * x)
        return (u + 1.0) - 2.0 * h * h
    return u - math.cos(x)


class Spherical(SeriesStyle):
    """Terms, and the function of each of the three angles."""

    def functions(self):
        return factor, self.function


def spherical_d2(phi, theta1, theta2, first, count, terms):
    pp = p1 = p2 = t11 = t12 = t22 = 0.0
    for k in range(int(first), int(first) + int(count)):
        C, K, L, M = terms[k, 0], terms[k, 1], terms[k, 4], terms[k, 7]
        x, y, z = K * (phi - terms[k, 2]), L * (theta1 - terms[k, 5]), M * (theta2 - terms[k, 8])
        f, g, h = factor(terms[k, 3], x), factor(terms[k, 6], y), factor(terms[k, 9], z)
        df, dg, dh = K * math.sin(x), L * math.sin(y), M * math.sin(z)
        pp += C * K * K * math.cos(x) * g * h
        t11 += C * f * L * L * math.cos(y) * h
        t22 += C * f * g * M * M * math.cos(z)
        p1 += C * df * dg * h
        p2 += C * df * g * dh
        t12 += C * f * dg * dh
    return (pp, p1, p2), (p1, t11, t12), (p2, t12, t22)


@dihedral("spherical", cls=Spherical, count="n", term=TERM, example=EXAMPLE, d2=spherical_d2)
def spherical(phi, theta1, theta2, first, count, terms: "array"):
    e = slope = bend1 = bend2 = 0.0
    for k in range(int(first), int(first) + int(count)):
        C, K, L, M = terms[k, 0], terms[k, 1], terms[k, 4], terms[k, 7]
        x, y, z = K * (phi - terms[k, 2]), L * (theta1 - terms[k, 5]), M * (theta2 - terms[k, 8])
        f, g, h = factor(terms[k, 3], x), factor(terms[k, 6], y), factor(terms[k, 9], z)
        e += C * f * g * h
        slope += C * K * math.sin(x) * g * h
        bend1 += C * f * L * math.sin(y) * h
        bend2 += C * f * g * M * math.sin(z)
    return e, slope, bend1, bend2
