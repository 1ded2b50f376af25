r"""$$E = K_{SS} (r_{12} - r_{12,0})(r_{32} - r_{32,0}) + K_{BS0} (r_{12} - r_{12,0})(\theta - \theta_0)
    + K_{BS1} (r_{32} - r_{32,0})(\theta - \theta_0)$$

Stretch-stretch and bend-stretch coupling alone, as in PCFF and in force fields of the MM3 kind.
Source: LAMMPS manual, angle_style cross.
"""
from __future__ import annotations

from asemd.style import angle


def cross_d2(theta, r12, r32, KSS, KBS0, KBS1, r12_0, r32_0, theta0):
    return (0.0, KBS0, KBS1), (KBS0, 0.0, KSS), (KBS1, KSS, 0.0)


@angle("cross", example="200.0 80.0 75.0 0.95 1.30 107.0", equilibrium="theta0", d2=cross_d2)
def cross(theta, r12, r32, KSS: "energy/distance^2", KBS0: "energy/distance", KBS1: "energy/distance", r12_0: "distance",
          r32_0: "distance", theta0: "angle"):
    d, u, v = theta - theta0, r12 - r12_0, r32 - r32_0
    bend = KBS0 * u + KBS1 * v
    return KSS * u * v + bend * d, bend, KSS * v + KBS0 * d, KSS * u + KBS1 * d
