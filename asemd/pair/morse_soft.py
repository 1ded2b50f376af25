r"""$$E = s D_0 \left[ x^2 - 2x \right] - \tfrac{2}{3} t D_0 e^{-2 \alpha r_0} (e^{\alpha r_0} - 1)\, x^3,
    \qquad x = e^{-\alpha (r - r_0)}$$

Morse that turns off with lambda, for free energies. Up to the value `range` of lambda, s and t are (lambda/range)^n; beyond it s is 1 and t
falls to 0 at lambda = 1, which is Morse. ``pair_modify shift yes`` has no effect, as in LAMMPS.  LAMMPS manual, pair_style morse/soft.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair


def derived(c, settings):
    """Factors of the Morse function and of the cube."""
    lam, top = c["lambda"], settings["range"]
    soft = (lam / top) ** settings["n"] if lam <= top else 1.0
    cube = soft if lam <= top else (1.0 - lam) / (1.0 - top)
    rise = math.exp(c["alpha"] * c["r0"])
    return {"depth": soft * c["d0"], "cube": -2.0 / 3.0 * cube * c["d0"] * (rise - 1.0) / (rise * rise)}


class SoftMorsePair(PairStyle):
    """Keeps lambda and the range between 0 and 1."""

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if not 0.0 < values["range"] <= 1.0:
            raise InputError(f"pair_style {self.name}: range must be more than 0 and at most 1, got {values['range']:g}")
        return values

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if not 0.0 <= values["lambda"] <= 1.0:
            raise InputError(f"pair_coeff {self.name}: lambda must be between 0 and 1, got {values['lambda']:g}")
        return values


def morse_soft_d2(r, depth, alpha, r0, cube):
    x = math.exp(-alpha * (r - r0))
    return alpha * alpha * x * (depth * (4.0 * x - 2.0) + 9.0 * cube * x * x)


@pair("morse/soft", settings="n range cut", coeff="d0 alpha r0 lambda [cut]", derived=derived, rows="depth cube", shifts=False,
      cls=SoftMorsePair,
      units={"d0": "energy", "n": "integer"}, settings_example="4 0.9 2.5", example="1.0 2.0 1.2 0.7 2.4", d2=morse_soft_d2,
      see="LAMMPS manual, pair_style morse/soft")
def morse_soft(r, depth: "energy", alpha: "1/distance", r0: "distance", cube: "energy"):
    x = math.exp(-alpha * (r - r0))
    return x * (depth * (x - 2.0) + cube * x * x), -alpha * x * (2.0 * depth * (x - 1.0) + 3.0 * cube * x * x)
