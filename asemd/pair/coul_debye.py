r"""$$E = C \frac{q_i q_j}{\epsilon r} e^{-\kappa r} \qquad r < r_c$$

Coulomb interaction screened by ions of a solution; kappa is the inverse Debye length.
Source: LAMMPS manual, pair_style coul/debye.
"""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def coul_debye_d2(r, qq, kappa):
    rinv = 1.0 / r
    return qq * rinv * math.exp(-kappa * r) * (kappa * kappa + 2.0 * rinv * (kappa + rinv))


@pair("coul/debye", scales=True, settings="kappa cut", coeff="[cut]", mix={"cut": "distance"}, settings_example="0.3 10.0", example="9.0",
      see="LAMMPS manual, pair_style coul/debye", d2=coul_debye_d2)
def coul_debye(r, qq, kappa: "1/distance"):
    rinv = 1.0 / r
    e = qq * rinv * math.exp(-kappa * r)
    return e, -e * (kappa + rinv)
