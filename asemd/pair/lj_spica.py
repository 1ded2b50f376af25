r"""E = f epsilon [(sigma/r)^n - (sigma/r)^m] for r < cut, with (n, m) = (9, 6), (12, 4), (12, 5) or (12, 6) and minimum -epsilon.

Pairs of the coarse-grained SPICA (formerly SDK, CMM) force field; the word lj9_6, lj12_4, lj12_5 or lj12_6 says the exponents. angle_style
spica adds the part of it inside the minimum for the ends of an angle. Shinoda, DeVane and Klein, Mol. Simul. 33, 27 (2007).
"""
from __future__ import annotations

import inspect
import math
import sys

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, make_part, pack_parts
from asemd.style import register

EXPONENTS = {"lj9_6": (9, 6), "lj12_4": (12, 4), "lj12_5": (12, 5), "lj12_6": (12, 6)}


def lj_spica(r2, front: "energy", sigma: "distance", n, m):
    r2inv = 1.0 / r2
    s = sigma * math.sqrt(r2inv)
    s2 = s * s
    s4 = s2 * s2
    low = s4 if m < 4.5 else (s4 * s if m < 5.5 else s4 * s2)
    ratio = s2 * s if n < 10.0 else (s4 * s4 if m < 4.5 else (s4 * s2 * s if m < 5.5 else s4 * s2))
    e = front * low
    return e * (ratio - 1.0), -0.5 * e * (n * ratio - m) * r2inv


def lj_spica_d2(r2, front, sigma, n, m):
    s = sigma / math.sqrt(r2)
    return 0.25 * front * (n * (n + 2.0) * math.pow(s, n) - m * (m + 2.0) * math.pow(s, m)) / (r2 * r2)


lj_spica.d2 = lj_spica_d2


class SpicaPair(PairStyle):
    """Turns the word for the exponents into numbers, and has tables of repulsive 1-3 pairs for angle_style spica."""

    repulsion_parts = (make_part(lj_spica, "", ("front", "sigma", "n", "m")),)

    def __init__(self, name: str):
        super().__init__(name, [(lj_spica, "cut")], settings="cut", coeff="lj_type epsilon sigma [cut]", rows="front n m",
                         units={"lj_type": "word", "epsilon": "energy"}, settings_example="8.0", example="lj9_6 0.1 3.0 7.5",
                         see="LAMMPS manual, pair_style lj/spica", doc=inspect.getdoc(sys.modules[__name__]))

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if values["lj_type"] not in EXPONENTS:
            raise InputError(f"pair_coeff {self.name}: unknown type {values['lj_type']!r}, use one of {' '.join(EXPONENTS)}")
        return values

    @staticmethod
    def numbers(c) -> dict[str, float]:
        """Arguments of the function for the coefficients of one pair of types."""
        n, m = EXPONENTS[c["lj_type"]]
        return {**c, "front": n / (n - m) * (n / m) ** (m / (n - m)) * c["epsilon"], "n": n, "m": m}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        return super().pack_pairs(settings, {pair: self.numbers(c) for pair, c in filled.items()}, ntypes, units, shift)

    def repulsion(self, filled, ntypes: int):
        """`PairTables` of `repulsion_parts`: the potential inside its minimum, moved up so that it ends at zero."""
        def end(c):
            return (c["sigma"] * (c["n"] / c["m"]) ** (1.0 / (c["n"] - c["m"])),)
        return pack_parts(self.repulsion_parts, {}, {pair: self.numbers(c) for pair, c in filled.items()}, ntypes, end, shift=True)


style = register(SpicaPair("lj/spica"))
