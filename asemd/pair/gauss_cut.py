r"""$$E = \frac{H}{\sigma_h \sqrt{2\pi}} \exp \left[ -\frac{(r - r_{mh})^2}{2 \sigma_h^2} \right] \qquad r < r_c$$

A Gaussian hill at the distance rmh, such as the hydration barrier of ions in implicit water.
Lenart, Jusufi and Panagiotopoulos, J. Chem. Phys. 126, 044509 (2007).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, mix_energy, pair


def derived(c, settings):
    """Height of the hill."""
    return {"height": c["hgauss"] / (math.sqrt(2.0 * math.pi) * c["sigmah"])}


def check(coeff, settings):
    if not coeff["sigmah"] > 0.0:
        raise InputError(f"pair_coeff gauss/cut: sigmah must be > 0, got {coeff['sigmah']:g}")


class GaussCutPair(PairStyle):
    """Mixes H as an energy, with sign."""

    def mixed(self, a, b, rule):
        sign = 1.0 if max(a["hgauss"], b["hgauss"]) >= 0.0 else -1.0
        return super().mixed(a, b, rule) | {
            "hgauss": sign * mix_energy(rule, abs(a["hgauss"]), abs(b["hgauss"]), a["sigmah"], b["sigmah"])}


def gauss_cut_d2(r, height, rmh, sigmah):
    x = (r - rmh) / sigmah
    return height * math.exp(-0.5 * x * x) * (x - 1.0) * (x + 1.0) / (sigmah * sigmah)


@pair("gauss/cut", settings="cut", coeff="hgauss rmh sigmah [cut]", rows="height", derived=derived, check=check, cls=GaussCutPair,
      d2=gauss_cut_d2, mix={"rmh": "distance", "sigmah": "distance"}, units={"hgauss": "energy*distance"}, settings_example="3.5",
      example="0.2805 1.45 0.5 3.4", see="LAMMPS manual, pair_style gauss/cut")
def gauss_cut(r, height: "energy", rmh: "distance", sigmah: "distance"):
    x = (r - rmh) / sigmah
    e = height * math.exp(-0.5 * x * x)
    return e, -e * x / sigmah
