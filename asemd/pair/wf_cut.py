r"""$$E = \epsilon \alpha \left[ (\sigma/r)^{2\mu} - 1 \right] \left[ (r_c/r)^{2\mu} - 1 \right]^{2\nu}, \qquad
    \alpha = 2\nu (r_c/\sigma)^{2\mu} \left[ \frac{1 + 2\nu}{2\nu \left[ (r_c/\sigma)^{2\mu} - 1 \right]} \right]^{2\nu + 1}$$

Lennard-Jones-like and smooth at its end; the depth of the minimum is epsilon, nu and mu are whole numbers.
Wang, Ramirez-Hinestrosa, Dobnikar and Frenkel, Phys. Chem. Chem. Phys. 22, 10624 (2020).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair


def derived(c, settings):
    """The factor epsilon alpha."""
    nu, reach = c["nu"], (c["cut"] / c["sigma"]) ** (2 * c["mu"])
    return {"front": c["epsilon"] * 2.0 * nu * reach * ((1.0 + 2.0 * nu) / (2.0 * nu) / (reach - 1.0)) ** (2 * nu + 1)}


class WangFrenkelPair(PairStyle):
    """Checks the exponents and that the cutoff is beyond sigma."""

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if values["nu"] < 1 or values["mu"] < 1:
            raise InputError(f"pair_coeff wf/cut: nu and mu must be at least 1, got {values['nu']} and {values['mu']}")
        cut = values.get("cut", settings["cut"])
        if not cut > values["sigma"] > 0.0:
            raise InputError(f"pair_coeff wf/cut: sigma = {values['sigma']:g} must be more than 0 and less than the cutoff {cut:g}")
        return values


def wf_cut_d2(r2, front, sigma, nu, mu, cut):
    a, b = math.pow(sigma * sigma / r2, mu), math.pow(cut * cut / r2, mu)
    rest = math.pow(b - 1.0, 2.0 * nu - 2.0)
    p = a * (b - 1.0) + 2.0 * nu * (a - 1.0) * b
    near = mu * (a * (b - 1.0) + a * b + 2.0 * nu * b * (2.0 * a - 1.0)) + p
    return front * mu / (r2 * r2) * rest * (mu * (2.0 * nu - 1.0) * b * p + (b - 1.0) * near)


@pair("wf/cut", settings="cut", coeff="epsilon sigma nu mu [cut]", derived=derived, rows="front", cls=WangFrenkelPair,
      units={"epsilon": "energy", "nu": "integer", "mu": "integer"}, settings_example="2.0", example="1.0 1.1 1 2 2.4",
      see="LAMMPS manual, pair_style wf/cut", d2=wf_cut_d2)
def wf_cut(r2, front: "energy", sigma: "distance", nu, mu, cut: "distance"):
    r2inv = 1.0 / r2
    a = math.pow(sigma * sigma * r2inv, mu)
    b = math.pow(cut * cut * r2inv, mu)
    rest = math.pow(b - 1.0, 2.0 * nu - 1.0)
    return front * (a - 1.0) * rest * (b - 1.0), -front * mu * rest * (a * (b - 1.0) + 2.0 * nu * (a - 1.0) * b) * r2inv
