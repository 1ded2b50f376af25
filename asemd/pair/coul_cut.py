r"""E = C q_i q_j / (dielectric r) for r < cut.  C is the Coulomb constant of the unit style."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


@pair("coul/cut", settings="cut", coeff="[cut]", mix={"cut": "distance"}, settings_example="10.0", example="9.0",
      see="LAMMPS manual, pair_style coul/cut")
def coul_cut(r2, qq):
    r2inv = 1.0 / r2
    e = qq * math.sqrt(r2inv)
    return e, -0.5 * e * r2inv
