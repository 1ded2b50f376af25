r"""E = C q_i q_j / (dielectric r) for r < cut.  C is the Coulomb constant of the unit style."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def coul_cut_d2(r2, qq):
    r2inv = 1.0 / r2
    return 0.75 * qq * math.sqrt(r2inv) * r2inv * r2inv


@pair("coul/cut", scales=True, settings="cut", coeff="[cut]", mix={"cut": "distance"}, settings_example="10.0", example="9.0",
      see="LAMMPS manual, pair_style coul/cut", d2=coul_cut_d2)
def coul_cut(r2, qq):
    r2inv = 1.0 / r2
    e = qq * math.sqrt(r2inv)
    return e, -0.5 * e * r2inv
