r"""$$E = K (\theta - \theta_0)^2$$

Spring in the angle; the usual factor 1/2 is included in K, which is per radian squared. Source: LAMMPS manual, angle_style harmonic.
"""
from __future__ import annotations

from asemd.style import angle


def harmonic_d2(theta, K, theta0):
    return 2.0 * K


@angle("harmonic", example="75.0 110.1", equilibrium="theta0", d2=harmonic_d2)
def harmonic(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    return K * d * d, 2.0 * K * d
