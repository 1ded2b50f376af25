r"""$$E = C \frac{q_i q_j}{\epsilon r} \left[ \mathrm{erfc}(g r) - \left(1 + \frac{r}{\lambda}\right) e^{-2 r / \lambda} \right]$$

The part of coul/slater/cut within the cutoff that a long-range solver leaves; erfc is LAMMPS's approximation, see coul/long.
Gonzalez-Melchor et al., J. Chem. Phys. 125, 224107 (2006).
"""
from __future__ import annotations

import math

from asemd.pair.coul_long import EWALD, coul_long_d2, long_range
from asemd.pairstyle import pair_sum


def special(r2, qq, lamda, g_ewald, off):
    r = math.sqrt(r2)
    x, y = g_ewald * r, r / lamda
    gauss, cloud, part = math.exp(-x * x), math.exp(-2.0 * y), 1.0 - off
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    e = qq / r
    return (e * (tail - (1.0 + y) * cloud - off * (1.0 - (1.0 + y) * cloud)),
            -0.5 * e * (tail + 1.12837917 * x * gauss - off - part * (1.0 + 2.0 * y * (1.0 + y)) * cloud) / r2)


@long_range(*EWALD)
def coul_slater_long(r2, qq, lamda: "distance", g_ewald):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    r = r2 * rinv
    x = g_ewald * r
    y = r / lamda
    gauss = math.exp(-x * x)
    cloud = math.exp(-2.0 * y)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    e = qq * rinv
    return e * (tail - (1.0 + y) * cloud), -0.5 * e * (tail + 1.12837917 * x * gauss - (1.0 + 2.0 * y * (1.0 + y)) * cloud) * r2inv


def coul_slater_long_d2(r2, qq, lamda, g_ewald):
    r = math.sqrt(r2)
    y = r / lamda
    cloud = math.exp(-2.0 * y) * (3.0 + y * (6.0 + y * (6.0 + 4.0 * y)))
    return coul_long_d2(r2, qq, g_ewald) - 0.25 * qq * cloud / (r2 * r2 * r)


coul_slater_long.special = special
coul_slater_long.d2 = coul_slater_long_d2
pair_sum("coul/slater/long", (coul_slater_long, "cut"), scales=True, settings="lamda cut", settings_example="1.5 10.0",
         see="LAMMPS manual, pair_style coul/slater/long")
