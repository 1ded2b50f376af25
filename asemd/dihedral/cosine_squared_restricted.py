r"""$$E = K \frac{(\cos\phi - \cos\phi_0)^2}{\sin^2\phi}$$

Torsion that cannot become planar: the energy diverges there, but for phi0 = 0 or 180 degrees on one side only.
Source: Bulacu et al., J. Chem. Theory Comput. 9, 3282 (2013); LAMMPS manual, dihedral_style cosine/squared/restricted.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def cosine_squared_restricted_d2(phi, K, phi0):
    s, c = math.sin(0.5 * phi), math.cos(0.5 * phi)
    if phi0 == 0.0:                      # K tan^2(phi/2)
        t = s / c
        return K * (0.5 / (c * c) + t * t) / (c * c)
    if abs(phi0) == math.pi:
        t = c / s
        return K * (0.5 / (s * s) + t * t) / (s * s)
    s0, c0 = math.sin(0.5 * phi0), math.cos(0.5 * phi0)
    p, m = math.sin(0.5 * (phi + phi0)), math.sin(0.5 * (phi - phi0))
    q = -p * m / (s * c)                    # the energy is K q^2
    first = -0.25 * (p * p + m * m) / (s * c * s * c)
    second = 0.5 * (s0 * s0 * c / (s * s * s) - c0 * c0 * s / (c * c * c))
    return 2.0 * K * (first * first + q * second)


@dihedral("cosine/squared/restricted", example="10.0 120.0", d2=cosine_squared_restricted_d2,
          domain="the four atoms must not lie in a plane, unless phi0 is that angle")
def cosine_squared_restricted(phi, K: "energy", phi0: "angle"):
    s = math.sin(0.5 * phi)
    c = math.cos(0.5 * phi)
    if abs(phi) >= math.pi:
        c = 0.0                       # trans exactly: cos(phi/2) of the rounded angle is not 0
    if phi0 == 0.0:
        if c == 0.0:
            return math.inf, math.inf
        t = s / c
        return K * t * t, K * t / (c * c)
    if s == 0.0:
        return math.inf, math.inf
    if abs(phi0) == math.pi:
        t = c / s
        return K * t * t, -K * t / (s * s)
    if c == 0.0:
        return math.inf, math.inf
    p = math.sin(0.5 * (phi + phi0))  # cos(phi0) - cos(phi) = 2 p m, 1 - cos(phi) cos(phi0) = p^2 + m^2, sin(phi) = 2 s c
    m = math.sin(0.5 * (phi - phi0))
    q = p * m / (s * c)
    return K * q * q, 0.5 * K * q * (p * p + m * m) / (s * c * s * c)
