r"""$$E = K [\cos\theta - \cos\theta_0]^2$$

Spring in the cosine of the angle, used by DREIDING and GROMOS; the usual factor 1/2 is included in K.
Source: LAMMPS manual, angle_style cosine/squared.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_squared_d2(theta, K, theta0):
    d, s = -2.0 * math.sin(0.5 * (theta + theta0)) * math.sin(0.5 * (theta - theta0)), math.sin(theta)
    return 2.0 * K * (s * s - d * math.cos(theta))


@angle("cosine/squared", example="75.0 110.1", equilibrium="theta0", d2=cosine_squared_d2)
def cosine_squared(theta, K: "energy", theta0: "angle"):
    d = -2.0 * math.sin(0.5 * (theta + theta0)) * math.sin(0.5 * (theta - theta0))     # cos(theta) - cos(theta0)
    return K * d * d, -2.0 * K * d * math.sin(theta)
