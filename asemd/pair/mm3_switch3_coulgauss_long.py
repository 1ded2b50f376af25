r"""$$E = \epsilon \left[ 1.84 \cdot 10^5 \, e^{-12 r / r_v} - 2.25 \, (r_v / r)^6 \right] S_3(r) + C \frac{q_i q_j}{\epsilon r}
\mathrm{erf}\left( r / \sqrt{\gamma_i^2 + \gamma_j^2} \right)$$

The van der Waals energy of MM3 with r_v = 2 sigma, switched off over the last `width` before its cutoff, and the Coulomb interaction of
Gaussian charges of lj/switch3/coulgauss/long; r_v of unlike types is the sum of both sigma, and epsilon the geometric mean.
Allinger, Yuh and Lii, J. Am. Chem. Soc. 111, 8551 (1989).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.pair import born
from asemd.pair.coul_long import coul_long
from asemd.pair.lj_switch3_coulgauss_long import OPTIONS, coul_gauss, switched_tail
from asemd.pairstyle import pair_sum


def van_der_waals(r, c):
    return c["epsilon"] * (184000.0 * np.exp(-6.0 * r / c["sigma"]) - 2.25 * (2.0 * c["sigma"] / r) ** 6)


def beyond(c, cut):
    e, sigma = c["epsilon"], c["sigma"]
    return born.tail({"a": 184000.0 * e, "rho": sigma / 6.0, "sigma": 0.0, "c": 2.25 * e * (2.0 * sigma) ** 6, "d": 0.0}, cut)


def mm3_switch3(r, epsilon: "energy", sigma: "distance", cut_lj: "distance", width: "distance"):
    rinv = 1.0 / r
    s = 2.0 * sigma * rinv
    s2 = s * s
    rate = 6.0 / sigma
    repulsion = 184000.0 * epsilon * math.exp(-rate * r)
    attraction = 2.25 * epsilon * s2 * s2 * s2
    e = repulsion - attraction
    d = 6.0 * attraction * rinv - rate * repulsion
    gap = cut_lj - r
    x = gap / width if gap < width else 1.0
    switch = x * x * (3.0 - 2.0 * x)
    slope = -6.0 * x * (1.0 - x) / width if gap < width else 0.0
    return e * switch, d * switch + e * slope


def mm3_switch3_d2(r, epsilon, sigma, cut_lj, width):
    rate, gap = 6.0 / sigma, cut_lj - r
    repulsion, attraction = 184000.0 * epsilon * math.exp(-rate * r), 2.25 * epsilon * (2.0 * sigma / r) ** 6
    e, d = repulsion - attraction, 6.0 * attraction / r - rate * repulsion
    second = rate * rate * repulsion - 42.0 * attraction / (r * r)
    if gap >= width:
        return second
    x = gap / width
    return second * x * x * (3.0 - 2.0 * x) - 12.0 * d * x * (1.0 - x) / width + 6.0 * e * (1.0 - 2.0 * x) / (width * width)


mm3_switch3.d2 = mm3_switch3_d2
pair_sum("mm3/switch3/coulgauss/long", (mm3_switch3, "cut_lj"), (coul_gauss, "cut_lj"), (coul_long, "cut_coul"),
         tail=switched_tail(van_der_waals, beyond), see="LAMMPS manual, pair_style mm3/switch3/coulgauss/long",
         **OPTIONS | {"mix": OPTIONS["mix"] | {"epsilon": "geometric", "sigma": "arithmetic"}})
