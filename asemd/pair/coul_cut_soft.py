r"""$$E = \lambda^n C \frac{q_i q_j}{\epsilon \sqrt{\alpha_C (1 - \lambda)^2 + r^2}} \qquad r < r_c$$

Coulomb interaction with a soft core, for free energies of particles that appear or vanish: finite at r = 0 for lambda below 1, coul/cut for
lambda = 1. Types mix only if their lambda is the same.  Beutler et al., Chem. Phys. Lett. 222, 529 (1994).
"""
from __future__ import annotations

import math

from asemd.pair.lj_cut_soft import SoftPair
from asemd.pairstyle import pair


def derived(c, settings):
    """The factor with lambda, and what stands beside r^2."""
    return {"weight": c["lambda"] ** settings["n"], "gap": settings["alphaC"] * (1.0 - c["lambda"]) ** 2}


def coul_soft_d2(r2, qq, weight, gap):
    s = 1.0 / (gap + r2)
    return 0.75 * qq * weight * math.sqrt(s) * s * s


@pair("coul/cut/soft", settings="n alphaC cut", coeff="lambda [cut]", derived=derived, rows="weight gap", cls=SoftPair,
      mix={"cut": "distance"}, units={"alphaC": "distance^2"}, settings_example="2.0 5.0 10.0", example="0.8 9.0", d2=coul_soft_d2,
      see="LAMMPS manual, pair_style coul/cut/soft")
def coul_soft(r2, qq, weight, gap: "distance^2"):
    s = 1.0 / (gap + r2)
    e = qq * weight * math.sqrt(s)
    return e, -0.5 * e * s
