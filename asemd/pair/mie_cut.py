r"""$$E = C \epsilon \left[ (\sigma/r)^{n} - (\sigma/r)^{m} \right] \qquad r < r_c, \qquad
    C = \frac{n}{n - m} \left( \frac{n}{m} \right)^{m / (n - m)}$$

Lennard-Jones with any exponents n (gamR) and m (gamA); the depth of the minimum is epsilon. Exponents of unlike types mix as distances.
Mie, Ann. Phys. 316, 657 (1903).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import pair, power_tail


def derived(c, settings):
    """The factor of both powers; the limit where m is 0."""
    n, m = c["gamR"], c["gamA"]
    return {"front": (n / (n - m) * (n / m) ** (m / (n - m)) if m else 1.0) * c["epsilon"]}


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair."""
    n, m, front = c["gamR"], c["gamA"], derived(c, {})["front"]
    return power_tail(((front * c["sigma"] ** n, n), (-front * c["sigma"] ** m, m)), cut)


def check(coeff, settings):
    if coeff["gamR"] == coeff["gamA"]:
        raise InputError(f"pair_coeff mie/cut: the exponents gamR and gamA must differ, both are {coeff['gamR']:g}")


def mie_cut_d2(r2, front, sigma, gamR, gamA):
    s2 = sigma * sigma / r2
    return 0.25 * front * (gamR * (gamR + 2.0) * math.pow(s2, 0.5 * gamR) - gamA * (gamA + 2.0) * math.pow(s2, 0.5 * gamA)) / (r2 * r2)


@pair("mie/cut", settings="cut", coeff="epsilon sigma gamR gamA [cut]", rows="front", derived=derived, tail=tail, check=check,
      mix={"epsilon": "sigma", "sigma": "distance", "gamR": "distance", "gamA": "distance"}, d2=mie_cut_d2, splits=True,
      units={"epsilon": "energy"}, settings_example="2.5", example="1.0 1.1 14.0 6.5 2.4", see="LAMMPS manual, pair_style mie/cut")
def mie_cut(r2, front: "energy", sigma: "distance", gamR, gamA):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    repulsion = front * math.pow(s2, 0.5 * gamR)
    attraction = front * math.pow(s2, 0.5 * gamA)
    return repulsion - attraction, 0.5 * (gamA * attraction - gamR * repulsion) * r2inv
