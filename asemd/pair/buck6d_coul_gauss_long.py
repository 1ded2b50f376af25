r"""$$E = \left[ A e^{-\rho r} - \frac{C}{r^6 (1 + D r^{-14})} \right] S(r)
+ C_e q_i q_j \frac{\mathrm{erf}(\alpha r) - \mathrm{erf}(g r)}{r} S_e(r) \qquad S = (1 - x)^3 (1 + 3 x + 6 x^2)$$

Force field MOF-FF as in buck6d/coul/gauss/dsf, with the part of the smeared charges that a long-range solver leaves. x goes from 0 at
smooth times cut_lj to 1 at cut_lj, and in S_e from smooth_coul times cut_coul to cut_coul; from 1 on nothing is switched off. Special
pairs lose the part of q_i q_j erf(alpha r) / r that special_bonds takes off, all of it, also where S_e switches.
Bureekaew et al., Phys. Status Solidi B 250, 1128 (2013).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair import buck6d_coul_gauss_dsf as dsf
from asemd.pair.coul_long import EWALD, long_range
from asemd.pairstyle import pair_sum


def derived(c, settings):
    """Where the switches begin and how wide they are."""
    start, end = (min(settings[name], 1.0) * cut for name, cut in (("smooth", c["cut_lj"]), ("smooth_coul", settings["cut_coul"])))
    return {"start": start, "width": c["cut_lj"] - start or 1.0, "start_coul": end, "width_coul": settings["cut_coul"] - end or 1.0}


def check(coeff, settings):
    if not settings["cut_coul"] > 0.0 or not 0.0 <= min(settings["smooth"], settings["smooth_coul"]):
        raise InputError("pair_style buck6d/coul/gauss/long: the cutoffs must be positive, smooth and smooth_coul must not be negative")


@long_range(*EWALD)
def coul_gauss(r2, qq, alpha: "1/distance", start_coul, width_coul, g_ewald):
    rinv = 1.0 / math.sqrt(r2)
    r = r2 * rinv
    e = qq * (math.erfc(g_ewald * r) - math.erfc(alpha * r)) * rinv
    bells = 1.12837917 * (alpha * math.exp(-alpha * alpha * r2) - g_ewald * math.exp(-g_ewald * g_ewald * r2))
    beyond = r - start_coul
    x = beyond / width_coul if beyond > 0.0 else 0.0
    gap = 1.0 - x
    switch = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    slope = -30.0 * x * x * gap * gap / width_coul
    return e * switch, 0.5 * rinv * ((qq * bells - e) * rinv * switch + e * slope)


def special(r2, qq, alpha, start_coul, width_coul, g_ewald, off):
    rinv = 1.0 / math.sqrt(r2)
    r = r2 * rinv
    near = qq * math.erf(alpha * r) * rinv
    bell = qq * 1.12837917 * alpha * math.exp(-alpha * alpha * r2)
    far = qq * math.erf(g_ewald * r) * rinv
    bells = bell - qq * 1.12837917 * g_ewald * math.exp(-g_ewald * g_ewald * r2)
    x = max(r - start_coul, 0.0) / width_coul
    gap = 1.0 - x
    switch = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    slope = -30.0 * x * x * gap * gap / width_coul
    return ((near - far) * switch - off * near,
            0.5 * rinv * ((bells - near + far) * rinv * switch + (near - far) * slope - off * (bell - near) * rinv))


def coul_gauss_d2(r2, qq, alpha, start_coul, width_coul, g_ewald):
    r = math.sqrt(r2)
    near, far = alpha * math.exp(-alpha * alpha * r2), g_ewald * math.exp(-g_ewald * g_ewald * r2)
    e = qq * (math.erfc(g_ewald * r) - math.erfc(alpha * r)) / r
    d = (qq * 1.12837917 * (near - far) - e) / r
    dd = -2.0 * qq * 1.12837917 * (alpha * alpha * near - g_ewald * g_ewald * far) - 2.0 * d / r
    x = max(r - start_coul, 0.0) / width_coul
    gap = 1.0 - x
    switch, slope = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x)), -30.0 * x * x * gap * gap / width_coul
    curve = -60.0 * x * gap * (1.0 - 2.0 * x) / (width_coul * width_coul)
    return 0.25 * (dd * switch + 2.0 * d * slope + e * curve - (d * switch + e * slope) / r) / r2


coul_gauss.special, coul_gauss.d2 = special, coul_gauss_d2
pair_sum("buck6d/coul/gauss/long", (dsf.buck6d, "cut_lj"), (coul_gauss, "cut_coul"), settings="smooth smooth_coul cut_lj [cut_coul]",
         coeff="A rho C D alpha [cut_lj]", rows="start width start_coul width_coul", defaults={"cut_coul": "cut_lj"}, derived=derived,
         check=check, settings_example="0.9 0.8 8.0 10.0", example="10304.0 3.0612 457.18 4.06448 0.6108 7.5",
         see="LAMMPS manual, pair_style buck6d/coul/gauss/long")
