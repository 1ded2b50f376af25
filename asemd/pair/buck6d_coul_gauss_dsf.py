r"""$$E = \left[ A e^{-\rho r} - \frac{C}{r^6 (1 + D r^{-14})} \right] S(r) + C_e q_i q_j \left[ \frac{\mathrm{erf}(\alpha r)}{r}
- \frac{\mathrm{erf}(\alpha r_c)}{r_c} - f (r - r_c) \right] \qquad S = (1 - x)^3 (1 + 3 x + 6 x^2)$$

Force field MOF-FF: a Buckingham function that is finite at r = 0, up to cut_lj, and the Coulomb energy of charges smeared out as Gauss
functions up to cut_coul, where f takes its slope to zero. x goes from 0 at smooth times cut_lj to 1 at cut_lj; from smooth = 1 on nothing
is switched off. One cutoff given means both. Special pairs lose the part of q_i q_j / r that special_bonds takes off, but those that are
left out (weights 0) have no such part either, as in LAMMPS.
Bureekaew et al., Phys. Status Solidi B 250, 1128 (2013).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.coul_wolf import ROOT_PI, bare_listed
from asemd.pairstyle import pair_sum


def derived(c, settings):
    """Where the switch begins and how wide it is; how far Coulomb energy and force stand from zero at the end."""
    start, end, alpha = min(settings["smooth"], 1.0) * c["cut_lj"], settings["cut_coul"], c["alpha"]
    near, bell = math.erf(alpha * end) / end, 2.0 * alpha / ROOT_PI
    tilt = (bell * math.exp(-alpha * alpha * end * end) - near) / end
    return {"start": start, "width": c["cut_lj"] - start or 1.0, "bell": bell, "tilt": tilt, "level": near - tilt * end}


def check(coeff, settings):
    if not settings["cut_coul"] > 0.0 or not 0.0 <= settings["smooth"]:
        raise InputError("pair_style buck6d/coul/gauss/dsf: the cutoffs must be positive, smooth must not be negative")


def buck6d_d2(r, A, rho, C, D, start, width):
    decay, s = A * math.exp(-rho * r), 1.0 / (r**14 + D)
    e = decay - C * r**8 * s
    d = -rho * decay - C * s * (8.0 * r**7 - 14.0 * r**21 * s)
    dd = rho * rho * decay - C * s * (56.0 * r**6 - 406.0 * r**20 * s + 392.0 * r**34 * s * s)
    x = max(r - start, 0.0) / width
    gap = 1.0 - x
    switch, slope = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x)), -30.0 * x * x * gap * gap / width
    return dd * switch + 2.0 * d * slope - e * 60.0 * x * gap * (1.0 - 2.0 * x) / (width * width)


def buck6d(r, A: "energy", rho: "1/distance", C: "energy*distance^6", D: "distance^14", start, width):
    r2 = r * r
    r6 = r2 * r2 * r2
    s = 1.0 / (r6 * r6 * r2 + D)
    decay = A * math.exp(-rho * r)
    e = decay - C * r6 * r2 * s
    d = -rho * decay - C * r6 * r * s * (8.0 - 14.0 * r6 * r6 * r2 * s)
    beyond = r - start
    x = beyond / width if beyond > 0.0 else 0.0
    gap = 1.0 - x
    switch = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    return e * switch, d * switch - e * 30.0 * x * x * gap * gap / width


def coul_gauss_d2(r2, qq, alpha, bell, level, tilt):
    r = math.sqrt(r2)
    near, gauss = math.erf(alpha * r) / r, bell * math.exp(-alpha * alpha * r2)
    return 0.25 * qq * (3.0 * (near - gauss) / r2 - 2.0 * alpha * alpha * gauss + tilt / r) / r2


@bare_listed
def coul_gauss(r2, qq, alpha: "1/distance", bell, level, tilt):
    r = math.sqrt(r2)
    gauss = math.exp(-alpha * alpha * r2)
    near = (1.0 - math.erfc(alpha * r)) / r
    return qq * (near - level - tilt * r), -0.5 * qq * ((near - bell * gauss) / r2 + tilt / r)


buck6d.d2, coul_gauss.d2 = buck6d_d2, coul_gauss_d2
pair_sum("buck6d/coul/gauss/dsf", (buck6d, "cut_lj"), (coul_gauss, "cut_coul"), settings="smooth cut_lj [cut_coul]",
         coeff="A rho C D alpha [cut_lj]", rows="start width bell level tilt", defaults={"cut_coul": "cut_lj"}, derived=derived,
         check=check, settings_example="0.9 8.0 10.0", example="10304.0 3.0612 457.18 4.06448 0.6108 7.5",
         see="LAMMPS manual, pair_style buck6d/coul/gauss/dsf")
