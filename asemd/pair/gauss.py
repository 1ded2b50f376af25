r"""$$E = -A e^{-B r^2} \qquad r < r_c$$

A Gaussian well (A > 0), such as that of a tether site, or hill. Widths of unlike types mix as lengths, 1/sqrt(2 B); a pair of which one
is repulsive (A < 0) is repulsive.
"""
from __future__ import annotations

import math

from asemd.pairstyle import PairStyle, mix_distance, mix_energy, pair


class GaussPair(PairStyle):
    """Mixes depths as energies and widths as lengths, both with signs."""

    def mixed(self, a, b, rule):
        out = super().mixed(a, b, rule)
        widths = [math.sqrt(0.5 / abs(c["b"])) if c["b"] else math.inf for c in (a, b)]
        width = mix_distance(rule, *widths)
        sign = -1.0 if min(a["a"], b["a"]) < 0.0 else 1.0
        return {"a": sign * mix_energy(rule, abs(a["a"]), abs(b["a"]), *widths),
                "b": math.copysign(0.5 / (width * width), max(a["b"], b["b"])), **out}


def gauss_d2(r2, a, b):
    return -a * b * b * math.exp(-b * r2)


@pair("gauss", settings="cut", coeff="a b [cut]", cls=GaussPair, mix={"cut": "distance"}, d2=gauss_d2, settings_example="2.5",
      example="1.0 0.9 2.4", see="LAMMPS manual, pair_style gauss")
def gauss(r2, a: "energy", b: "1/distance^2"):
    e = -a * math.exp(-b * r2)
    return e, -b * e
