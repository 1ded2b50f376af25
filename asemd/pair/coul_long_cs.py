r"""coul/long for cores and shells of polarisable atoms: special pairs may stand in one place.

The complementary error function is LAMMPS's approximation for these styles (errors below 5e-8). Special pairs are met as if they were 1e-6
farther apart, as LAMMPS does; their force, too, is LAMMPS's, which differs from the gradient of this energy by 1e-6 / r.
Other parts take 1e-12 more than r^2.
Mitchell and Fincham, J. Phys. Condens. Matter 5, 1031 (1993).
"""
from __future__ import annotations

import math

from asemd.coulomb_table import coul_long_cs_table
from asemd.pair.coul_long import EWALD, coul_long_d2, long_range
from asemd.pairstyle import pair_sum


def special(r2, qq, g_ewald, off):
    r = math.sqrt(r2 + 1e-20) + 1e-6
    x = g_ewald * r
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.995473818 * x)
    u = 1.0 - t
    p = -0.1335096380159268 + u * (-0.257839507 + u * (-0.137203639 + u * (-0.00888822059 + u * (-0.00580844129 + u * 0.114652755))))
    tail = t * (1.0 + p * u) * gauss - off
    e = qq / r
    return e * tail, -0.5 * e * (tail + 1.12837917 * x * gauss) / (r2 + 1e-12)


@long_range(*EWALD)
def coul_long_cs(r2, qq, g_ewald):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    x = g_ewald * (r2 * rinv)
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.995473818 * x)
    u = 1.0 - t
    p = -0.1335096380159268 + u * (-0.257839507 + u * (-0.137203639 + u * (-0.00888822059 + u * (-0.00580844129 + u * 0.114652755))))
    tail = t * (1.0 + p * u) * gauss
    e = qq * rinv
    return e * tail, -0.5 * e * (tail + 1.12837917 * x * gauss) * r2inv


coul_long_cs.special, coul_long_cs.d2, coul_long_cs.table = special, coul_long_d2, coul_long_cs_table
coul_long_cs.core = 1e-12
pair_sum("coul/long/cs", (coul_long_cs, "cut"), scales=True, settings="cut", settings_example="10.0",
         see="LAMMPS manual, pair_style coul/long/cs")
