r"""$$E = \lambda^n \epsilon \left[ \frac{2}{D^{3/2}} - \frac{3}{D} \right], \qquad
    D = \alpha (1 - \lambda)^2 + (r/\sigma)^6 \qquad r < r_c$$

Lennard-Jones 9-6 (lj/class2) with a soft core, for free energies; see lj/cut/soft.
"""
from __future__ import annotations

import math

from asemd.pair.lj_class2 import Class2Pair
from asemd.pair.lj_cut_soft import SoftPair, derived
from asemd.pairstyle import pair, power_tail


class SoftClass2Pair(SoftPair, Class2Pair):
    """Mixes as lj/class2, and nothing of different lambda."""


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair, of powers without the soft core."""
    s3, e = c["sigma"] ** 3, c["epsilon"] * c["lambda"] ** c["power"]
    return power_tail(((2.0 * e * s3 * s3 * s3, 9), (-3.0 * e * s3 * s3, 6)), cut)


def lj_class2_soft_d2(r2, front, core, sigma):
    s2 = sigma * sigma
    u = r2 / s2
    d = 1.0 / (core + u * u * u)
    root = math.sqrt(d)
    slope, curve = 3.0 * u * u / s2, 6.0 * u / (s2 * s2)
    return front * (7.5 * root - 6.0) * d * d * d * slope * slope + 3.0 * front * (1.0 - root) * d * d * curve


@pair("lj/class2/soft", settings="n alpha cut", coeff="epsilon sigma lambda [cut]", derived=derived, rows="front core", cls=SoftClass2Pair,
      mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, units={"epsilon": "energy"}, settings_example="2.0 0.5 2.5",
      example="1.0 1.1 0.6 2.4", d2=lj_class2_soft_d2, see="LAMMPS manual, pair_style lj/class2/soft")
def lj_class2_soft(r2, front: "energy", core, sigma: "distance"):
    s2 = 1.0 / (sigma * sigma)
    u = r2 * s2
    d = 1.0 / (core + u * u * u)
    root = math.sqrt(d)
    e = front * d
    return e * (2.0 * root - 3.0), 9.0 * e * d * (1.0 - root) * u * u * s2
