r"""$$E = \frac{C}{\epsilon} \sum_{i < j} q_i q_j \left[ \frac{\mathrm{erfc}(\alpha r)}{r} - \frac{\mathrm{erfc}(\alpha r_c)}{r_c}
+ \left( \frac{\mathrm{erfc}(\alpha r_c)}{r_c^2} + \frac{2 \alpha}{\sqrt\pi} \frac{e^{-\alpha^2 r_c^2}}{r_c} \right) (r - r_c) \right]$$

Damped Coulomb energy whose force goes to zero at the cutoff, instead of a sum over all images; each charge adds an energy of its own, a
constant times q^2. Special pairs lose the part of q_i q_j / r that special_bonds takes off. The complementary error function is LAMMPS's
approximation (Abramowitz and Stegun 7.1.26, errors below 1.5e-7), and its derivative that of the exact function, as in LAMMPS.
Fennell and Gezelter, J. Chem. Phys. 124, 234104 (2006).
"""
from __future__ import annotations

import math

from asemd.pair.coul_wolf import DampedPair, DampedSum, bare_special, coul_wolf_d2
from asemd.pairstyle import pair_sum


class ForceShiftedPair(DampedPair):
    """What a charge has by itself follows from the energy with its linear part."""

    level = "start"


class ForceShiftedSum(DampedSum):
    """The same beside a Lennard-Jones or Born part."""

    level = "start"


def coul_dsf_d2(r2, qq, alpha, bell, start, end):
    return coul_wolf_d2(r2, qq, alpha, bell, 0.0) + 0.25 * qq * end / (r2 * math.sqrt(r2))


@bare_special
def coul_dsf(r2, qq, alpha: "1/distance", bell, start, end):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    r = r2 * rinv
    gauss = math.exp(-alpha * alpha * r2)
    t = 1.0 / (1.0 + 0.3275911 * alpha * r)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    c = qq * rinv
    return c * (tail - r * start - r2 * end), -0.5 * c * ((tail * rinv + bell * gauss) * rinv + end)


@bare_special
def coul_dsf_exact(r2, qq, alpha: "1/distance", bell, start, end):
    """With the exact complementary error function, as in the styles born/coul/dsf."""
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    r = r2 * rinv
    near = math.erfc(alpha * r) * rinv
    return qq * (near - start - r * end), -0.5 * qq * rinv * ((near + bell * math.exp(-alpha * alpha * r2)) * rinv + end)


coul_dsf.d2 = coul_dsf_exact.d2 = coul_dsf_d2
APPROXIMATE = {"gradient": "LAMMPS's erfc is good to 1.5e-7, and its force is that of the exact function"}
pair_sum("coul/dsf", (coul_dsf, "cut"), cls=ForceShiftedPair, settings="alpha cut", settings_example="0.2 10.0", xfail=APPROXIMATE,
         see="LAMMPS manual, pair_style coul/dsf")
