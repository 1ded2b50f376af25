r"""$$E = C q_i q_j \left[ \frac{1}{r} - \frac{1}{r_c} \gamma\!\left( \frac{r^2}{r_c^2} \right) \right] \qquad r < r_c$$

The part of the Coulomb energy within the cutoff that multilevel summation (kspace_style msm) leaves; gamma(u) is the Taylor polynomial of
1/sqrt(u) around 1, of half the degree of ``kspace_modify order``. Special pairs lose the part of their bare energy that special_bonds takes
off.  Hardy et al., J. Chem. Theory Comput. 12, 2892 (2016).
"""
from __future__ import annotations

import math

from asemd.coulomb_table import coul_msm_table
from asemd.pair.coul_long import long_range
from asemd.pairstyle import pair

SMOOTH = {f"smooth{n}": f"1/distance^{2 * n + 1}" for n in range(6)}


def coul_msm_d2(r2, qq, smooth0, smooth1, smooth2, smooth3, smooth4, smooth5):
    curve = 2.0 * smooth2 + r2 * (6.0 * smooth3 + r2 * (12.0 * smooth4 + r2 * 20.0 * smooth5))
    return qq * (0.75 / (r2 * r2 * math.sqrt(r2)) - curve)


@pair("coul/msm", scales=True, settings="cut", coeff="", settings_example="10.0", example="", see="LAMMPS manual, pair_style coul/msm",
      d2=coul_msm_d2, units=SMOOTH)
@long_range("msm")
def coul_msm(r2, qq, smooth0, smooth1, smooth2, smooth3, smooth4, smooth5):
    r2inv = 1.0 / r2
    bare = qq * math.sqrt(r2inv)
    smooth = smooth0 + r2 * (smooth1 + r2 * (smooth2 + r2 * (smooth3 + r2 * (smooth4 + r2 * smooth5))))
    slope = smooth1 + r2 * (2.0 * smooth2 + r2 * (3.0 * smooth3 + r2 * (4.0 * smooth4 + r2 * 5.0 * smooth5)))
    return bare - qq * smooth, -0.5 * bare * r2inv - qq * slope


coul_msm.table = coul_msm_table
