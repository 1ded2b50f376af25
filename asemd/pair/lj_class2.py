r"""$$E = \epsilon \left[ 2 (\sigma/r)^9 - 3 (\sigma/r)^6 \right] \qquad r < r_c$$

Lennard-Jones 9-6 of the class 2 force fields; sigma is where the minimum is, whose depth is epsilon. Pairs of unlike types mix by the rule
``sixthpower``, whatever pair_modify says; only their cutoff follows it.  Sun, J. Phys. Chem. B 102, 7338 (1998).
"""
from __future__ import annotations

import math

from asemd.pairstyle import PairStyle, pair, power_tail


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair (equation 5 of the source)."""
    s3 = c["sigma"] ** 3
    return power_tail(((2.0 * c["epsilon"] * s3 * s3 * s3, 9), (-3.0 * c["epsilon"] * s3 * s3, 6)), cut)


class Class2Pair(PairStyle):
    """Mixes epsilon and sigma by sixth powers, cutoffs as pair_modify says."""

    def mixed(self, a, b, rule):
        out = super().mixed(a, b, "sixthpower")
        return out | {n: v for n, v in super().mixed(a, b, rule).items() if n.startswith("cut")}


def lj_class2_d2(r2, epsilon, sigma):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s3 = s2 * math.sqrt(s2)
    return epsilon * s3 * s3 * (49.5 * s3 - 36.0) * r2inv * r2inv


@pair("lj/class2", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, cls=Class2Pair,
      settings_example="2.5", example="1.0 1.1 2.4", see="LAMMPS manual, pair_style lj/class2", d2=lj_class2_d2, splits=True)
def lj_class2(r2, epsilon: "energy", sigma: "distance"):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s3 = s2 * math.sqrt(s2)
    e = epsilon * s3 * s3
    return e * (2.0 * s3 - 3.0), -9.0 * e * (s3 - 1.0) * r2inv
