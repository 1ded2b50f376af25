r"""$$E = K \Delta^2 [1 - 0.802141 \Delta + 0.183837 \Delta^2 - 0.131664 \Delta^3 + 0.237090 \Delta^4], \quad \Delta = \theta - \theta_0$$

Angle of the MM3 force field; the factors are 0.014, 5.6e-5, 7e-7 and 2.2e-8 per power of a degree, in radians.

The cubic term of LAMMPS's force has another factor than its energy asks for: off by 4e-5 of its size at 10 degrees from theta0, 4e-4 at
20 and 5e-3 at 40. Here the force is minus the gradient; ``compat="lammps"``
gives LAMMPS's force. Source: Allinger, Yuh and Lii, J. Am. Chem. Soc. 111, 8551 (1989); LAMMPS manual, angle_style mm3.
"""
from __future__ import annotations

from asemd.style import angle


def mm3_lammps(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    e = K * d * d * (1.0 + d * (-0.802141 + d * (0.183837 + d * (-0.131664 + d * 0.237090))))
    return e, 2.0 * K * d * (1.0 + d * (-1.203211 + d * (0.367674 + d * (-0.3239159 + d * 0.711270))))


def mm3_d2(theta, K, theta0):
    d = theta - theta0
    return K * (2.0 + d * (-4.812846 + d * (2.206044 + d * (-2.63328 + d * 7.1127))))


@angle("mm3", example="75.0 110.1", equilibrium="theta0", lammps=mm3_lammps, d2=mm3_d2)
def mm3(theta, K: "energy", theta0: "angle"):
    d = theta - theta0
    e = K * d * d * (1.0 + d * (-0.802141 + d * (0.183837 + d * (-0.131664 + d * 0.237090))))
    return e, K * d * (2.0 + d * (-2.406423 + d * (0.735348 + d * (-0.65832 + d * 1.42254))))
