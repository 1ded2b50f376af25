r"""$$E = \frac{A}{\kappa} e^{-\kappa (r - R_i - R_j)} \qquad r < r_c$$

Screened repulsion of charged colloid spheres of radii R; A is the coefficient alpha. All atoms of a type have the same radius.
Safran, Statistical Thermodynamics of Surfaces, Interfaces, and Membranes (1994).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, largest_radii, pair


class YukawaColloidPair(PairStyle):
    """Takes the radii of the types."""

    def learn(self, settings, system):
        if "radius" not in system.extra:
            raise InputError(f"pair style {self.name} needs atom attribute radius: use atom_style sphere")
        settings["radii"] = radii = largest_radii(system)
        if (np.array(radii)[system.type] != system.extra["radius"]).any():
            raise InputError(f"pair style {self.name}: all atoms of a type must have the same radius")

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        radii = settings.get("radii", (0.5,) * (ntypes + 1))
        return {(i, j): {**c, "contact": radii[i] + radii[j]} for (i, j), c in super().filled(coeffs, settings, ntypes, rule, only).items()}


def yukawa_colloid_d2(r, alpha, contact, kappa):
    return alpha * kappa * math.exp(-kappa * (r - contact))


@pair("yukawa/colloid", settings="kappa cut", coeff="alpha [cut]", mix={"alpha": "geometric"}, rows="contact", cls=YukawaColloidPair,
      units={"kappa": "1/distance"}, d2=yukawa_colloid_d2, settings_example="2.0 2.5", example="10.0 2.4",
      see="LAMMPS manual, pair_style yukawa/colloid")
def yukawa_colloid(r, alpha: "energy/distance", contact: "distance", kappa: "1/distance"):
    slope = alpha * math.exp(-kappa * (r - contact))
    return slope / kappa, -slope
