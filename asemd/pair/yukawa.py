r"""$$E = A \frac{e^{-\kappa r}}{r} \qquad r < r_c$$

Screened Coulomb repulsion of particles; A is the coefficient alpha."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def yukawa_d2(r, alpha, kappa):
    x = kappa * r
    return alpha * math.exp(-x) * (2.0 + x * (2.0 + x)) / (r * r * r)


@pair("yukawa", settings="kappa cut", coeff="alpha [cut]", mix={"alpha": "geometric"}, units={"kappa": "1/distance"}, d2=yukawa_d2,
      settings_example="2.0 2.5", example="10.0 2.4", see="LAMMPS manual, pair_style yukawa")
def yukawa(r, alpha: "energy*distance", kappa: "1/distance"):
    rinv = 1.0 / r
    e = alpha * math.exp(-kappa * r) * rinv
    return e, -e * (kappa + rinv)
