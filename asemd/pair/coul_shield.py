r"""$$E = \mathrm{Tap}(r) \, C \frac{q_i q_j}{\left(r^3 + \lambda^{-3}\right)^{1/3}} \qquad
\mathrm{Tap}(r) = 20 x^7 - 70 x^6 + 84 x^5 - 35 x^4 + 1, \; x = r / r_c$$

Coulomb interaction between the layers of van der Waals materials, finite at r = 0: only atoms of different molecules interact. Without the
taper (tap_flag 0) it ends abruptly. Maaravi, Leven, Azuri, Kronik and Hod, J. Phys. Chem. C 121, 22826 (2017).

``pair_modify shift yes`` has no effect: LAMMPS's offset holds the charges of two atoms that have nothing to do with the pair.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.coul_diel import UnshiftedPair
from asemd.pairstyle import pair


class ShieldPair(UnshiftedPair):
    """Pairs of different molecules only."""

    molecules = "other"

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if values["tap_flag"] not in (0, 1):
            raise InputError(f"pair_style {self.name}: tap_flag must be 0 or 1, got {values['tap_flag']}")
        return values

    def check_scene(self, interactions, system):
        super().check_scene(interactions, system)
        if not system.molecular:
            raise InputError(f"pair_style {self.name} needs an atom_style with molecule numbers, such as full")


def coul_shield_d2(r, qq, cut, lamda, tap_flag):
    third, x = 1.0 / (lamda * lamda * lamda), r / cut
    s = 1.0 / (r * r * r + third)
    e = qq * math.pow(s, 0.3333333333333333)
    d, second = -e * r * r * s, e * r * s * (4.0 * r * r * r * s - 2.0)
    if tap_flag == 0.0:
        return second
    gap, x2 = 1.0 - x, x * x
    tap = gap * gap * gap * gap * (1.0 + x * (4.0 + x * (10.0 + 20.0 * x)))
    slope = -140.0 * x2 * x * gap * gap * gap / cut
    bend = -420.0 * x2 * gap * gap * (1.0 - 2.0 * x) / (cut * cut)
    return second * tap + 2.0 * d * slope + e * bend


@pair("coul/shield", cls=ShieldPair, settings="cut [tap_flag]", coeff="lamda [cut]", defaults={"tap_flag": 1},
      units={"tap_flag": "integer"}, settings_example="10.0 1", example="0.7",
      see="LAMMPS manual, pair_style coul/shield", d2=coul_shield_d2)
def coul_shield(r, qq, cut: "distance", lamda: "1/distance", tap_flag):
    x = r / cut
    r2 = r * r
    inverse = 1.0 / (r * r2 + 1.0 / (lamda * lamda * lamda))
    e = qq * math.pow(inverse, 0.3333333333333333)
    d = -e * r2 * inverse
    gap = 1.0 - x
    gap3 = gap * gap * gap
    tap = gap3 * gap * (1.0 + x * (4.0 + x * (10.0 + 20.0 * x)))
    slope = -140.0 * x * x * x * gap3 / cut
    whole = tap_flag == 0.0
    return (e if whole else e * tap), (d if whole else d * tap + e * slope)
