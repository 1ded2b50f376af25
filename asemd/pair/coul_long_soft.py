r"""$$E = \lambda^n C \frac{q_i q_j \, \mathrm{erfc}(g r)}{\epsilon \sqrt{\alpha_C (1 - \lambda)^2 + r^2}} \qquad r < r_c$$

Short-range part of coul/long with a soft core, for free energies of particles that appear or vanish; lambda = 1 is coul/long. Special pairs
lose the part of their bare energy, with its soft core, that special_bonds takes off. Types mix only if their lambda is the same.
Beutler et al., Chem. Phys. Lett. 222, 529 (1994).

LAMMPS's force is not minus the gradient of its energy for lambda below 1: the part of it that comes from the change of erfc has the cube
of the root below it. Here it is the gradient; ``compat="lammps"`` gives LAMMPS's force. erfc is LAMMPS's approximation, see coul/long.
"""
from __future__ import annotations

import math

from asemd.pair.coul_cut_soft import derived
from asemd.pair.coul_long import EWALD, long_range
from asemd.pair.lj_cut_soft import SoftPair
from asemd.pairstyle import pair_sum


def special(r2, qq, weight, gap, g_ewald, off):
    x = g_ewald * math.sqrt(r2)
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss - off
    s = 1.0 / (gap + r2)
    e = qq * weight * math.sqrt(s)
    return e * tail, -0.5 * e * (tail * s + (1.12837917 * x * gauss / r2 if r2 > 0.0 else 0.0))


def special_lammps(r2, qq, weight, gap, g_ewald, off):
    x = g_ewald * math.sqrt(r2)
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss - off
    s = 1.0 / (gap + r2)
    e = qq * weight * math.sqrt(s)
    return e * tail, -0.5 * e * s * (tail + 1.12837917 * x * gauss)


@long_range(*EWALD)
def coul_long_soft(r2, qq, weight, gap: "distance^2", g_ewald):
    r2inv = 1.0 / r2
    x = g_ewald * (r2 * math.sqrt(r2inv))
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    s = 1.0 / (gap + r2)
    e = qq * weight * math.sqrt(s)
    return e * tail, -0.5 * e * (tail * s + 1.12837917 * x * gauss * r2inv)


@long_range(*EWALD)
def coul_long_soft_lammps(r2, qq, weight, gap: "distance^2", g_ewald):
    x = g_ewald * math.sqrt(r2)
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    s = 1.0 / (gap + r2)
    e = qq * weight * math.sqrt(s)
    return e * tail, -0.5 * e * s * (tail + 1.12837917 * x * gauss)


def coul_long_soft_d2(r2, qq, weight, gap, g_ewald):
    x, s = g_ewald * math.sqrt(r2), 1.0 / (gap + r2)
    tail, bell = math.erfc(x), 1.12837917 * x * math.exp(-x * x)
    e = qq * weight * math.sqrt(s)
    return e * (0.75 * tail * s * s + 0.5 * bell * s / r2 + 0.25 * bell * (1.0 + 2.0 * x * x) / (r2 * r2))


coul_long_soft.special, coul_long_soft_lammps.special, coul_long_soft.d2 = special, special_lammps, coul_long_soft_d2
OPTIONS = dict(scales=True, settings="n alphaC cut", coeff="lambda", derived=derived, rows="weight gap", mix={"lambda": "distance"},
               units={"alphaC": "distance^2"}, settings_example="2.0 5.0 10.0", example="0.8",
               see="LAMMPS manual, pair_style coul/long/soft")
style = pair_sum("coul/long/soft", (coul_long_soft, "cut"), cls=SoftPair, **OPTIONS)
style.twin = SoftPair("coul/long/soft", [(coul_long_soft_lammps, "cut")], doc=__doc__, **OPTIONS)
