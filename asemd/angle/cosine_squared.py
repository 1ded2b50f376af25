r"""$$E = K [\cos\theta - \cos\theta_0]^2$$

Spring in the cosine of the angle, used by DREIDING and GROMOS; the usual factor 1/2 is included in K.
Source: LAMMPS manual, angle_style cosine/squared.
"""
from __future__ import annotations

import math

from asemd.style import angle


@angle("cosine/squared", example="75.0 110.1", equilibrium="theta0")
def cosine_squared(theta, K: "energy", theta0: "angle"):
    d = -2.0 * math.sin(0.5 * (theta + theta0)) * math.sin(0.5 * (theta - theta0))     # cos(theta) - cos(theta0)
    return K * d * d, -2.0 * K * d * math.sin(theta)
