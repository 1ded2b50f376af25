r"""$$E = -\epsilon \ln \left( 1 - e^{-r^2/\sigma^2} \right) \qquad r < r_c$$

The Uhlenbeck-Ford model, the reference of free energies of liquids. Below r = 0.7 sigma, (1 - exp(-x))/x comes from its power series, so
that no digits cancel. fix adapt may change the factor `scale` of energy and forces (in LAMMPS, of the forces only).
Paula Leite, Freitas, Azevedo and de Koning, J. Chem. Phys. 145, 194101 (2016).
"""
from __future__ import annotations

import math

from asemd.pairstyle import PairStyle, pair


class UfmPair(PairStyle):
    """Has a factor of the energy, `scale`, which fix adapt may change."""

    coefficients = ("scale",)

    def parse_coeff(self, words, settings):
        return super().parse_coeff(words, settings) | {"scale": 1.0}

    def mixed(self, a, b, rule):
        return super().mixed(a, b, rule) | {"scale": 1.0}


def ufm_d2(r2, epsilon, sigma, scale):
    s2 = sigma * sigma
    x = r2 / s2
    rest = -math.expm1(-x)
    return scale * epsilon * math.exp(-x) / (rest * rest * s2 * s2)


@pair("ufm", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, d2=ufm_d2, rows="scale",
      cls=UfmPair, settings_example="2.5", example="1.0 1.1 2.4", see="LAMMPS manual, pair_style ufm")
def ufm(r2, epsilon: "energy", sigma: "distance", scale):
    s2 = sigma * sigma
    x = r2 / s2
    decay = math.exp(-x)
    p = 1.1470745597729725e-11 * x - 1.6059043836821613e-10
    p = p * x + 2.08767569878681e-09
    p = p * x - 2.505210838544172e-08
    p = p * x + 2.755731922398589e-07
    p = p * x - 2.7557319223985893e-06
    p = p * x + 2.48015873015873e-05
    p = p * x - 0.0001984126984126984
    p = p * x + 0.001388888888888889
    p = p * x - 0.008333333333333333
    p = p * x + 0.041666666666666664
    p = p * x - 0.16666666666666666
    p = p * x + 0.5
    near = x * (1.0 - x * p)
    rest = near if x < 0.5 else 1.0 - decay
    front = scale * epsilon
    return -front * math.log(rest), -front * decay / (rest * s2)
