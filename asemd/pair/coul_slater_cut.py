r"""$$E = C \frac{q_i q_j}{r} \left[ 1 - \left(1 + \frac{r}{\lambda}\right) e^{-2 r / \lambda} \right] \qquad r < r_c$$

Coulomb interaction of charges smeared out as Slater densities with decay length lamda, finite at r = 0.
Gonzalez-Melchor et al., J. Chem. Phys. 125, 224107 (2006).
"""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def coul_slater_d2(r, qq, lamda):
    y = r / lamda
    x = 2.0 * y
    if x < 1.0:      # the sum of e^-x x^k/k! from k = 3 on and what follows from it, as in coul_slater
        p, term = 0.0, x * x * x / 6.0
        for k in range(4, 40):
            p += term
            term *= x / k
        inside = math.exp(-x) * p
    else:
        inside = 1.0 - math.exp(-x) * (1.0 + x + 0.5 * x * x)
    return qq / (r * r * r) * (2.0 * inside - 4.0 * y * y * y * math.exp(-x))


@pair("coul/slater/cut", scales=True, settings="lamda cut", coeff="[cut]", mix={"cut": "distance"}, settings_example="1.5 10.0",
      example="9.0", see="LAMMPS manual, pair_style coul/slater/cut", d2=coul_slater_d2)
def coul_slater(r, qq, lamda: "distance"):
    x = 2.0 * r / lamda
    w = math.exp(-x)
    # inside = 1 - e^-x (1 + x + x^2/2), e^-x times the sum of x^k/k! from k = 3 on where digits would cancel
    p = 1.5619206968586226e-16 * x + 2.8114572543455206e-15
    p = (p * x + 4.779477332387385e-14) * x + 7.647163731819816e-13
    p = (p * x + 1.1470745597729725e-11) * x + 1.6059043836821613e-10
    p = (p * x + 2.08767569878681e-09) * x + 2.505210838544172e-08
    p = (p * x + 2.755731922398589e-07) * x + 2.7557319223985893e-06
    p = (p * x + 2.48015873015873e-05) * x + 0.0001984126984126984
    p = (p * x + 0.001388888888888889) * x + 0.008333333333333333
    p = (p * x + 0.041666666666666664) * x + 0.16666666666666666
    series = w * x * x * x * p
    near = x < 1.0
    inside = series if near else 1.0 - w * (1.0 + x * (1.0 + 0.5 * x))
    rinv = 1.0 / r
    c = qq * rinv
    # 1 - (1 + x/2) e^-x = inside + e^-x (x + x^2) / 2
    return c * (inside + 0.5 * w * x * (1.0 + x)), -c * rinv * inside
