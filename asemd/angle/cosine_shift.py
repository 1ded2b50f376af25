r"""$$E = -\frac{U_{min}}{2} [1 + \cos(\theta - \theta_0)]$$

Bounded between -Umin, at theta0, and zero. Source: LAMMPS manual, angle_style cosine/shift.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_shift_d2(theta, Umin, theta0):
    return 0.5 * Umin * math.cos(theta - theta0)


@angle("cosine/shift", example="10.0 45.0", equilibrium="theta0", d2=cosine_shift_d2)
def cosine_shift(theta, Umin: "energy", theta0: "angle"):
    d = theta - theta0
    c = math.cos(0.5 * d)
    return -Umin * c * c, 0.5 * Umin * math.sin(d)
