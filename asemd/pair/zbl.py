r"""$$E = \frac{Z_i Z_j e^2}{4\pi\epsilon_0 r} \phi(r/a) + S(r), \qquad a = \frac{0.46850}{Z_i^{0.23} + Z_j^{0.23}}\,\text{A}$$
$$\phi(x) = 0.18175 e^{-3.19980 x} + 0.50986 e^{-0.94229 x} + 0.28022 e^{-0.40290 x} + 0.02817 e^{-0.20162 x}$$

Screened repulsion of nuclei in collisions; Zi and Zj are the atomic numbers. S takes energy, force and its derivative to zero between inner
and outer, as in lj/gromacs. Pairs of unlike types follow from the numbers of both. Special pairs whose weight (special_bonds)
is not 0 count in full, and where charges have a long-range solver those of weight 0, too, as in LAMMPS.
Ziegler, Biersack and Littmark, The Stopping and Range of Ions in Matter (1985).
"""
from __future__ import annotations

import math

from asemd import units as unit_systems
from asemd.errors import InputError
from asemd.pair.lj_gromacs import SwitchedPair, switch
from asemd.pairstyle import pair

AMPLITUDES = (0.18175, 0.50986, 0.28022, 0.02817)
DECAYS = (3.19980, 0.94229, 0.40290, 0.20162)


class ZblPair(SwitchedPair):
    """Numbers of nuclei by type; lengths and energies in the units of the scene."""

    all_or_nothing = True

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words, settings)
        if not (values["Zi"] > 0.0 and values["Zj"] > 0.0):
            raise InputError(f"pair_coeff zbl: Zi and Zj must be > 0, got {values['Zi']:g} and {values['Zj']:g}")
        return values

    def mixed(self, a, b, rule):
        return {"Zi": a["Zi"], "Zj": b["Zj"]}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        units = units or unit_systems.get("lj")
        full = {}
        for (i, j), c in filled.items():
            if i == j and c["Zi"] != c["Zj"]:
                raise InputError(f"pair_coeff {i} {j} zbl: Zi and Zj of one type must be equal, got {c['Zi']:g} and {c['Zj']:g}")
            size = (c["Zi"] ** 0.23 + c["Zj"] ** 0.23) / (0.46850 * units.angstrom)
            front, rc = c["Zi"] * c["Zj"] * units.qqr2e * units.qelectron**2, settings["outer"]
            terms = [(front * a / rc * math.exp(-d * size * rc), d * size) for a, d in zip(AMPLITUDES, DECAYS)]
            e = sum(t for t, _ in terms)
            slope = -sum(t * (d + 1.0 / rc) for t, d in terms)
            curve = sum(t * (d * d + 2.0 / rc * (d + 1.0 / rc)) for t, d in terms)
            names = ("third", "fourth", "constant")
            full[i, j] = {"front": front, "size": size, **dict(zip(names, switch(e, slope, curve, settings["inner"], rc)))}
        return super().pack_pairs(settings, full, ntypes, units, shift)


def zbl_d2(r, front, size, third, fourth, constant, inner):
    rinv, second = 1.0 / r, 0.0
    for a, d in ((0.18175, 3.19980), (0.50986, 0.94229), (0.28022, 0.40290), (0.02817, 0.20162)):
        k = d * size
        second += a * math.exp(-k * r) * (k * k + 2.0 * rinv * (k + rinv))
    t = r - inner if r > inner else 0.0
    return front * rinv * second + t * (6.0 * third + 12.0 * fourth * t)


@pair("zbl", settings="inner outer", coeff="Zi Zj", cut="outer", cls=ZblPair, mix={"Zi": "mean"}, rows="front size third fourth constant",
      d2=zbl_d2, shifts=False, settings_example="3.0 4.0", example="14.0 14.0", see="LAMMPS manual, pair_style zbl")
def zbl(r, front: "energy*distance", size: "1/distance", third, fourth, constant, inner: "distance"):
    rinv = 1.0 / r
    x = size * r
    a = 0.18175 * math.exp(-3.19980 * x)
    b = 0.50986 * math.exp(-0.94229 * x)
    c = 0.28022 * math.exp(-0.40290 * x)
    d = 0.02817 * math.exp(-0.20162 * x)
    e = front * rinv * (a + b + c + d)
    slope = front * rinv * size * (3.19980 * a + 0.94229 * b + 0.40290 * c + 0.20162 * d)
    t = r - inner if r > inner else 0.0
    return e + (t * t * t * (third + fourth * t) + constant), t * t * (3.0 * third + 4.0 * fourth * t) - slope - e * rinv
