r"""$$E = A_0 e^{-\alpha r} - A_1 e^{-\beta (r - r_0)^2} \qquad r < r_c$$

Born-Mayer repulsion and a Gaussian well, for metals. A cutoff in pair_coeff is read but has no effect, as in LAMMPS: all pairs have that of
pair_style.  Bomont and Bretonnet, J. Chem. Phys. 124, 054504 (2006).
"""
from __future__ import annotations

import math
import warnings

from asemd.errors import InputWarning
from asemd.pairstyle import PairStyle, pair


class BornGaussPair(PairStyle):
    """One cutoff for all pairs."""

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if "cut" in values:
            warnings.warn(f"pair_coeff born/gauss: the cutoff {values['cut']:g} has no effect, that of pair_style counts", InputWarning,
                          stacklevel=2)
        return values

    def cutoffs(self, coeff, settings):
        return [settings["cut"]]


def born_gauss_d2(r, biga0, alpha, biga1, beta, r0):
    x = r - r0
    return biga0 * alpha * alpha * math.exp(-alpha * r) - 2.0 * biga1 * beta * (2.0 * beta * x * x - 1.0) * math.exp(-beta * x * x)


@pair("born/gauss", settings="cut", coeff="biga0 alpha biga1 beta r0 [cut]", d2=born_gauss_d2, cls=BornGaussPair, settings_example="8.0",
      example="8.2464e13 12.48 0.042644277 0.44 3.56", see="LAMMPS manual, pair_style born/gauss")
def born_gauss(r, biga0: "energy", alpha: "1/distance", biga1: "energy", beta: "1/distance^2", r0: "distance"):
    x = r - r0
    repulsion = biga0 * math.exp(-alpha * r)
    well = biga1 * math.exp(-beta * x * x)
    return repulsion - well, 2.0 * beta * x * well - alpha * repulsion
