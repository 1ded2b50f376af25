r"""$$E = \phi(r) - \phi(r_c) - (r - r_c) \phi'(r_c), \qquad \phi = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] \qquad r < r_c$$

Lennard-Jones with shifted force: energy and force end at zero. With x = rc/r each power x^n - 1 - n (1 - 1/x) is (x - 1)^2 times a
polynomial, so that no digits cancel near the cutoff.

LAMMPS has two energies of special pairs: the one it adds up lacks their weights (special_bonds), that of single pairs (compute pair/local,
compute group/group) has them, like its forces. Ours is the second one, of which its forces are the gradient; ``compat="lammps"`` adds up
the first one.
Source: Toxvaerd and Dyre, J. Chem. Phys. 134, 081102 (2011).
"""
from __future__ import annotations

import copy
import math

from asemd.pairstyle import PairStyle
from asemd.style import register


def derived(c, settings):
    """Both powers at the cutoff."""
    s6 = (c["sigma"] / c["cut"]) ** 6
    return {"repulsion": 4.0 * c["epsilon"] * s6 * s6, "attraction": 4.0 * c["epsilon"] * s6}


def lj_smooth_linear_d2(r2, repulsion, attraction, cut):
    r = math.sqrt(r2)
    x6 = (cut * cut / r2) ** 3
    slope = -(12.0 * repulsion * (x6 * x6 * cut / r - 1.0) - 6.0 * attraction * (x6 * cut / r - 1.0)) / cut
    return 0.25 * (x6 * (156.0 * repulsion * x6 - 42.0 * attraction) / r2 - slope / r) / r2


def lj_smooth_linear(r2, repulsion: "energy", attraction: "energy", cut: "distance"):
    r = math.sqrt(r2)
    rinv = r / r2
    x = cut * rinv
    gap = (cut - r) * rinv          # x - 1
    sum6 = 1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x)))))      # (x^7 - 1)/(x - 1)
    x6 = x * x * x * x * x * x
    sum12 = sum6 + x6 * x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x)))))
    low = 6.0 + x * (5.0 + x * (4.0 + x * (3.0 + x * (2.0 + x))))
    high = 12.0 + x * (11.0 + x * (10.0 + x * (9.0 + x * (8.0 + x * (7.0 + x * low)))))
    weight = gap * (r / cut)
    e = weight * gap * (repulsion * high - attraction * low)
    return e, -0.5 * gap * (12.0 * repulsion * sum12 - 6.0 * attraction * sum6) / cut * rinv


lj_smooth_linear.d2 = lj_smooth_linear_d2


class LinearPair(PairStyle):
    """The style under each of its names."""

    def __init__(self, name: str, doc: str = __doc__):
        super().__init__(name, [(lj_smooth_linear, "cut")], settings="cut", coeff="epsilon sigma [cut]", derived=derived,
                         mix={"epsilon": "sigma", "sigma": "distance"}, rows="repulsion attraction", units={"epsilon": "energy",
                         "sigma": "distance"}, shifts=False, settings_example="2.5", example="1.0 1.1 2.4", doc=doc,
                         see="LAMMPS manual, pair_style lj/smooth/linear")
        self.twin = copy.copy(self)
        self.twin.unweighted = self


register(LinearPair("lj/smooth/linear"))
