r"""$$E = K [1 + \cos\theta]$$

Stiffness of a chain: the lowest energy is at 180 degrees. Source: LAMMPS manual, angle_style cosine.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_d2(theta, K):
    return -K * math.cos(theta)


@angle("cosine", example="75.0", rest=lambda coeff: 180.0, d2=cosine_d2)
def cosine(theta, K: "energy"):
    c = math.cos(0.5 * theta)      # 1 + cos(theta) = 2 cos^2(theta/2) loses no digits near 180 degrees
    return 2.0 * K * c * c, -K * math.sin(theta)
