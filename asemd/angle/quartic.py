r"""$$E = K_2 (\theta - \theta_0)^2 + K_3 (\theta - \theta_0)^3 + K_4 (\theta - \theta_0)^4$$

Spring in the angle that is stiffer on one side; the usual factor 1/2 is included in K2. Source: LAMMPS manual, angle_style quartic.
"""
from __future__ import annotations

from asemd.style import angle


def quartic_d2(theta, theta0, K2, K3, K4):
    d = theta - theta0
    return 2.0 * K2 + d * (6.0 * K3 + 12.0 * d * K4)


@angle("quartic", example="129.1948 56.8726 -25.9442 -14.2221", equilibrium="theta0", d2=quartic_d2)
def quartic(theta, theta0: "angle", K2: "energy", K3: "energy", K4: "energy"):
    d = theta - theta0
    return d * d * (K2 + d * (K3 + d * K4)), d * (2.0 * K2 + d * (3.0 * K3 + d * 4.0 * K4))
