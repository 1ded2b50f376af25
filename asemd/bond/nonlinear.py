r"""$$E = \frac{\epsilon (r - r_0)^2}{\lambda^2 - (r - r_0)^2}$$

Spring of finite extension: the energy diverges where the bond is longer or shorter than $r_0$ by $\lambda$.
Source: Rector, Van Swol and Henderson, Mol. Phys. 82, 1009 (1994); LAMMPS manual, bond_style nonlinear.
"""
from __future__ import annotations

import math

from asemd.style import bond


def nonlinear_d2(r, epsilon, r0, lamda):
    d = r - r0
    rest = (lamda - d) * (lamda + d)
    return 2.0 * epsilon * (lamda / rest) * (lamda / rest) * (lamda * lamda + 3.0 * d * d) / rest


@bond("nonlinear", example="100.0 1.1 1.4", equilibrium="r0", domain="the bond length must differ from r0 by less than lambda",
      d2=nonlinear_d2)
def nonlinear(r, epsilon: "energy", r0: "distance", lamda: "distance"):
    d = r - r0
    rest = (lamda - d) * (lamda + d)
    if not rest > 0.0:
        return math.inf, math.inf
    x = d / rest
    return epsilon * d * x, 2.0 * epsilon * (lamda / rest) * lamda * x
