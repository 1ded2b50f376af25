r"""$$E = \lambda^n C \frac{q_i q_j}{\epsilon \sqrt{\alpha_C (1 - \lambda)^2 + r^2}} \qquad r < r_c$$

Coulomb interaction that is switched on with lambda from 0 to 1 and stays finite at r = 0 on the way, for free energies (fix adapt/fep).
Beutler et al., Chem. Phys. Lett. 222, 529 (1994).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair


class SoftPair(PairStyle):
    """Pairs with a coupling `lambda`; rows made from it are ``front`` = lambda^n and what stands under the root."""

    def mixed(self, a, b, rule):
        if a["lambda"] != b["lambda"]:
            raise InputError(f"lambda is {a['lambda']:g} and {b['lambda']:g}: different values do not mix, give pair_coeff for that pair")
        return super().mixed(a, b, rule) | {"lambda": a["lambda"]}

    def numbers(self, c, settings):
        """Coefficients and what the functions take instead of lambda."""
        far = (1.0 - c["lambda"]) ** 2
        out = {**c, "front": c["lambda"] ** settings["nlambda"]}
        for name, alpha in (("gap", "alphaC"), ("soft", "alphaLJ")):
            if alpha in settings:
                out[name] = settings[alpha] * far
        return out

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        return super().pack_pairs(settings, {pair: self.numbers(c, settings) for pair, c in filled.items()}, ntypes, units, shift)


def coul_soft_d2(r2, qq, front, gap):
    s = 1.0 / (gap + r2)
    return 0.75 * qq * front * math.sqrt(s) * s * s


@pair("coul/cut/soft", cls=SoftPair, settings="nlambda alphaC cut", coeff="lambda [cut]", rows="front gap", mix={"cut": "distance"},
      units={"alphaC": "distance^2"}, settings_example="2.0 5.0 10.0", example="0.8 9.0", see="LAMMPS manual, pair_style coul/cut/soft",
      d2=coul_soft_d2)
def coul_soft(r2, qq, front, gap):
    s = 1.0 / (gap + r2)
    e = qq * front * math.sqrt(s)
    return e, -0.5 * e * s
