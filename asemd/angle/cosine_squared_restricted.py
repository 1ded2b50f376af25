r"""$$E = K \frac{(\cos\theta - \cos\theta_0)^2}{\sin^2\theta}$$

Spring in the cosine that keeps the angle away from 0 and 180 degrees, where torsions become undefined; the usual factor 1/2 is included
in K. Source: Bulacu et al., J. Chem. Theory Comput. 9, 3282 (2013); LAMMPS manual, angle_style cosine/squared/restricted.
"""
from __future__ import annotations

import math

from asemd.style import angle


@angle("cosine/squared/restricted", example="75.0 110.1", equilibrium="theta0", domain="the energy diverges at 0 and 180 degrees")
def cosine_squared_restricted(theta, K: "energy", theta0: "angle"):
    p, m = math.sin(0.5 * (theta + theta0)), math.sin(0.5 * (theta - theta0))
    s = math.sin(theta)
    if m == 0.0:
        return 0.0, 0.0
    if not 0.0 < theta < math.pi:                 # the nearest double to pi stands for a straight angle
        return math.inf, math.inf
    d = -2.0 * p * m / s                          # (cos(theta) - cos(theta0)) / sin(theta)
    return K * d * d, -2.0 * K * d * (p * p + m * m) / (s * s)     # 1 - cos(theta) cos(theta0) = p^2 + m^2
