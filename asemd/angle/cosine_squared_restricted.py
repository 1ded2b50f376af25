r"""$$E = K \frac{(\cos\theta - \cos\theta_0)^2}{\sin^2\theta}$$

Spring in the cosine that keeps the angle away from 0 and 180 degrees, where torsions become undefined; the usual factor 1/2 is included
in K. Source: Bulacu et al., J. Chem. Theory Comput. 9, 3282 (2013); LAMMPS manual, angle_style cosine/squared/restricted.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_squared_restricted_d2(theta, K, theta0):
    s, c = math.sin(0.5 * theta), math.cos(0.5 * theta)
    if theta0 == 0.0:                      # K tan^2(theta/2)
        t = s / c
        return K * (0.5 / (c * c) + t * t) / (c * c)
    if abs(theta0) == math.pi:
        t = c / s
        return K * (0.5 / (s * s) + t * t) / (s * s)
    s0, c0 = math.sin(0.5 * theta0), math.cos(0.5 * theta0)
    p, m = math.sin(0.5 * (theta + theta0)), math.sin(0.5 * (theta - theta0))
    q = -p * m / (s * c)                    # the energy is K q^2
    first = -0.25 * (p * p + m * m) / (s * c * s * c)
    second = 0.5 * (s0 * s0 * c / (s * s * s) - c0 * c0 * s / (c * c * c))
    return 2.0 * K * (first * first + q * second)


@angle("cosine/squared/restricted", example="75.0 110.1", equilibrium="theta0", domain="the energy diverges at 0 and 180 degrees",
       d2=cosine_squared_restricted_d2)
def cosine_squared_restricted(theta, K: "energy", theta0: "angle"):
    p, m = math.sin(0.5 * (theta + theta0)), math.sin(0.5 * (theta - theta0))
    s = math.sin(theta)
    if m == 0.0:
        return 0.0, 0.0
    if not 0.0 < theta < math.pi:                 # the nearest double to pi stands for a straight angle
        return math.inf, math.inf
    if theta0 == math.pi:                         # K cot^2(theta/2): one small number near the line, not three
        h = math.sin(0.5 * theta)
        t = math.cos(0.5 * theta) / h
        return K * t * t, -K * t / (h * h)
    d = -2.0 * p * m / s                          # (cos(theta) - cos(theta0)) / sin(theta)
    return K * d * d, -2.0 * K * d * (p * p + m * m) / (s * s)     # 1 - cos(theta) cos(theta0) = p^2 + m^2
