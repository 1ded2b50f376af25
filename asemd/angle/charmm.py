r"""$$E = K (\theta - \theta_0)^2 + K_{ub} (r_{13} - r_{ub})^2$$

Spring in the angle and a Urey-Bradley spring between the first and the third atom.
Source: MacKerell et al., J. Phys. Chem. B 102, 3586 (1998); LAMMPS manual, angle_style charmm.
"""
from __future__ import annotations

from asemd.style import angle


def charmm_d2(theta, r13, K, theta0, K_ub, r_ub):
    return (2.0 * K, 0.0), (0.0, 2.0 * K_ub)


@angle("charmm", example="75.0 110.1 50.0 3.0", equilibrium="theta0", d2=charmm_d2)
def charmm(theta, r13, K: "energy", theta0: "angle", K_ub: "energy/distance^2", r_ub: "distance"):
    d = theta - theta0
    u = r13 - r_ub
    return K * d * d + K_ub * u * u, 2.0 * K * d, 2.0 * K_ub * u
