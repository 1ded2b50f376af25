r"""$$E = K [1 - \cos(\theta - \theta_0)]$$

Spring in the angle that is bounded by 2K; the usual factor 1/2 is included in K. Source: LAMMPS manual, angle_style cosine/delta.
"""
from __future__ import annotations

import math

from asemd.style import angle


def cosine_delta_d2(theta, K, theta0):
    return K * math.cos(theta - theta0)


@angle("cosine/delta", example="75.0 110.1", equilibrium="theta0", d2=cosine_delta_d2)
def cosine_delta(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    s = math.sin(0.5 * d)
    return 2.0 * K * s * s, K * math.sin(d)
