r"""$$E = \frac{E_0}{n - m} \left[ m (r_0/r)^n - n (r_0/r)^m \right] \qquad r < r_c$$

Lennard-Jones with any two exponents, for ionic liquids; the minimum is at r0, its depth is e0.
Clarke, Smith and Woodcock, J. Chem. Phys. 84, 2290 (1986).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import pair, power_tail


def derived(c, settings):
    """The common factor of both powers."""
    return {"front": c["e0"] / (c["nn"] - c["mm"])}


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair."""
    n, m, front = c["nn"], c["mm"], derived(c, {})["front"]
    return power_tail(((front * m * c["r0"] ** n, n), (-front * n * c["r0"] ** m, m)), cut)


def check(coeff, settings):
    if coeff["nn"] == coeff["mm"]:
        raise InputError(f"pair_coeff nm/cut: the exponents nn and mm must differ, both are {coeff['nn']:g}")


def nm_cut_d2(r2, front, r0, nn, mm):
    s2 = r0 * r0 / r2
    return 0.25 * front * nn * mm * ((nn + 2.0) * math.pow(s2, 0.5 * nn) - (mm + 2.0) * math.pow(s2, 0.5 * mm)) / (r2 * r2)


@pair("nm/cut", settings="cut", coeff="e0 r0 nn mm [cut]", rows="front", derived=derived, tail=tail, check=check, d2=nm_cut_d2,
      units={"e0": "energy"}, settings_example="2.5", example="1.0 1.2 8.0 6.0 2.4", see="LAMMPS manual, pair_style nm/cut")
def nm_cut(r2, front: "energy", r0: "distance", nn, mm):
    r2inv = 1.0 / r2
    s2 = r0 * r0 * r2inv
    first = math.pow(s2, 0.5 * nn)
    second = math.pow(s2, 0.5 * mm)
    return front * (mm * first - nn * second), -0.5 * front * nn * mm * (first - second) * r2inv
