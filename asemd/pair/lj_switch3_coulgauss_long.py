r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] S_3(r) + C \frac{q_i q_j}{\epsilon r}
\mathrm{erf}\left( r / \sqrt{\gamma_i^2 + \gamma_j^2} \right)$$

Lennard-Jones switched off over the last `width` before its cutoff, S3 = 3 x^2 - 2 x^3 with x = (cut - r) / width, and the Coulomb
interaction of charges smeared out as Gaussians, of which this is the part within cut_coul that a long-range solver leaves; beyond cut_lj
they count as points. The gamma of unlike types always follows from that of the types themselves. ``pair_modify tail yes`` adds what
the switch takes off, too.
Vanduyfhuys et al., J. Comput. Chem. 39, 999 (2018).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.pair.coul_long import coul_long, coul_long_d2
from asemd.pairstyle import PairStyle, pair_sum, power_tail


class GaussianPair(PairStyle):
    """The width of the Gaussians of each pair of types; the width of the switch is the last setting."""

    def parse_settings(self, words):
        order = words if len(words) != 3 else [words[0], words[2], words[1]]
        return super().parse_settings(order)

    def format_settings(self, settings):
        lj, width, *coul = super().format_settings(settings)
        return [lj, *coul, width]

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        out = super().filled(coeffs, settings, ntypes, rule, only)
        for (i, j), c in out.items():
            c["width"] = settings["width"]
            if (i, i) in out and (j, j) in out:
                c["spread"] = math.hypot(*(out[t, t]["gamma"] for t in (i, j)))
        return out


def derived(c, settings):
    """What the distance is multiplied with in the error function: infinite for points, which the largest number stands for."""
    spread = c.get("spread", math.sqrt(2.0) * c["gamma"])
    return {"narrow": 1.0 / spread if spread > 0.0 else 1e150}


def switched_tail(energy, beyond):
    """The ``tail`` of a style: integrals of `beyond` the cutoff, and of what the switch takes off ``energy(r, coeff)`` before it."""
    nodes, weights = np.polynomial.legendre.leggauss(48)

    def tail(c, cut):
        width, (e, p) = c["width"], beyond(c, cut)
        if not width > 0.0:
            return e, p
        x = 0.5 * (1.0 + nodes)
        r = cut - width * x
        lost = math.pi * width * float(weights @ ((1.0 - x * x * (3.0 - 2.0 * x)) * energy(r, c) * r * r))
        return e + lost, e + lost      # nothing jumps: the integrals of energy and pressure are the same
    return tail


def lennard_jones(r, c):
    s6 = (c["sigma"] / r) ** 6
    return 4.0 * c["epsilon"] * s6 * (s6 - 1.0)


def beyond(c, cut):
    s6, e = c["sigma"] ** 6, 4.0 * c["epsilon"]
    return power_tail(((e * s6 * s6, 12), (-e * s6, 6)), cut)


def lj_switch3(r, epsilon: "energy", sigma: "distance", cut_lj: "distance", width: "distance"):
    rinv = 1.0 / r
    s = sigma * rinv
    s2 = s * s
    s6 = s2 * s2 * s2
    e = 4.0 * epsilon * s6 * (s6 - 1.0)
    d = -24.0 * epsilon * s6 * (2.0 * s6 - 1.0) * rinv
    gap = cut_lj - r
    x = gap / width if gap < width else 1.0
    switch = x * x * (3.0 - 2.0 * x)
    slope = -6.0 * x * (1.0 - x) / width if gap < width else 0.0
    return e * switch, d * switch + e * slope


def lj_switch3_d2(r, epsilon, sigma, cut_lj, width):
    s6 = (sigma / r) ** 6
    e, d = 4.0 * epsilon * s6 * (s6 - 1.0), -24.0 * epsilon * s6 * (2.0 * s6 - 1.0) / r
    second = 24.0 * epsilon * s6 * (26.0 * s6 - 7.0) / (r * r)
    gap = cut_lj - r
    if gap >= width:
        return second
    x = gap / width
    return second * x * x * (3.0 - 2.0 * x) - 12.0 * d * x * (1.0 - x) / width + 6.0 * e * (1.0 - 2.0 * x) / (width * width)


def coul_gauss(r2, qq, narrow):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    y = narrow * (r2 * rinv)
    e = -qq * rinv
    tail = math.erfc(y)
    return e * tail, -0.5 * e * (tail + 1.12837917 * y * math.exp(-y * y)) * r2inv


def coul_gauss_d2(r2, qq, narrow):
    return -coul_long_d2(r2, qq, narrow)


lj_switch3.d2, coul_gauss.d2 = lj_switch3_d2, coul_gauss_d2
OPTIONS = dict(cls=GaussianPair, settings="cut_lj width [cut_coul]", coeff="epsilon sigma gamma [cut_lj]", defaults={"cut_coul": "cut_lj"},
               mix={"epsilon": "sigma", "sigma": "distance", "gamma": "distance"}, derived=derived, rows="narrow",
               units={"gamma": "distance"}, settings_example="8.0 2.0", example="0.1 3.0 1.2 7.0")
pair_sum("lj/switch3/coulgauss/long", (lj_switch3, "cut_lj"), (coul_gauss, "cut_lj"), (coul_long, "cut_coul"),
         tail=switched_tail(lennard_jones, beyond), see="LAMMPS manual, pair_style lj/switch3/coulgauss/long", **OPTIONS)
