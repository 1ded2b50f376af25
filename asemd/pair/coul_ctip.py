r"""$$E = C \sum_{i < j} q_i q_j \left[ \frac{\mathrm{erfc}(\alpha r)}{r} - \frac1r + \frac{1}{\hat r} - k - l (r - r_c)
- \tfrac12 m (r - r_c)^2 \right] + \sum_i \left[ \chi q_i + \tfrac12 \eta q_i^2 + \omega x_i^2
- C \left(\tfrac12 s + \frac{\alpha}{\sqrt\pi} \right) q_i^2 \right] \qquad \hat r = (r^3 + \gamma^{-3})^{1/3}$$

Charge transfer ionic potential: the damped Coulomb energy of a neutral surrounding, shielded at short distances with
$\gamma = \sqrt{\gamma_i \gamma_j}$, and the energy of each ion by itself. k, l and m make the energy, the force and its slope go to zero at
the cutoff, s follows from them; x is what the charge is below qmin or above qmax. Charges are those of the atoms. A line of the file is an
element with chi, eta, gamma, zeta, Z, qmin, qmax and omega; zeta and Z do not count. Special pairs lose the part of q_i q_j / r that
special_bonds takes off, but those that are left out (weights 0) have no such part either, as in LAMMPS. The complementary error function
is LAMMPS's approximation, good to 1.5e-7, and its derivative that of the exact function.  Source: LAMMPS manual, pair_style coul/ctip.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.manybody import ManyBody, element_of
from asemd.pair.coul_dsf import APPROXIMATE
from asemd.pair.coul_wolf import ROOT_PI, bare_listed
from asemd.pairstyle import pack_parts
from asemd.potential_file import read_elements
from asemd.style import register

A1, A2, A3, A4, A5 = 0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429


def coul_ctip_d2(r2, qq, third, level, slope, bend, alpha, bell, cut):
    r = math.sqrt(r2)
    gauss = math.exp(-alpha * alpha * r2)
    near = (1.0 - math.erfc(alpha * r)) / r
    s = 1.0 / (r2 * r + third)
    shield = math.pow(s, 0.3333333333333333)
    first = (near - bell * gauss) / r - r2 * s * shield - slope - bend * (r - cut)
    second = -2.0 * (near - bell * gauss) / r2 + 2.0 * alpha * alpha * bell * gauss + shield * s * r * (4.0 * r2 * r * s - 2.0) - bend
    return 0.25 * qq * (second - first / r) / r2


@bare_listed
def coul_ctip(r2, qq, third, level, slope, bend, alpha: "1/distance", bell: "1/distance", cut: "distance"):
    r = math.sqrt(r2)
    gauss = math.exp(-alpha * alpha * r2)
    t = 1.0 / (1.0 + 0.3275911 * alpha * r)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    near = (1.0 - tail) / r
    s = 1.0 / (r2 * r + third)
    shield = math.pow(s, 0.3333333333333333)
    gap = r - cut
    e = shield - near - level - (slope + 0.5 * bend * gap) * gap
    return qq * e, 0.5 * qq * ((near - bell * gauss) / r2 - r * s * shield - (slope + bend * gap) / r)


coul_ctip.d2 = coul_ctip_d2


class ChargeTransfer(ManyBody):
    """A sum over pairs, with what ions have by themselves."""

    half_list = True

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if not values["cut"] > 0.0:
            raise InputError(f"pair_style {self.name}: the cutoff must be more than 0, got {values['cut']:g}")
        return values

    def read(self, file, elements, settings):
        return read_elements(file, elements, "chi eta gamma zeta Z qmin qmax omega", check)

    def constants(self, settings):
        return {"alpha": settings["alpha"], "bell": 2.0 * settings["alpha"] / ROOT_PI, "cut": settings["cut"]}

    def ends(self, settings, a, b) -> dict[str, float]:
        """What makes the energy of two elements end smoothly."""
        alpha, bell, cut = self.constants(settings).values()
        third = (a["gamma"] * b["gamma"]) ** -1.5
        gauss, t = math.exp(-alpha * alpha * cut * cut), 1.0 / (1.0 + 0.3275911 * alpha * cut)
        near = (1.0 - t * (A1 + t * (A2 + t * (A3 + t * (A4 + t * A5)))) * gauss) / cut
        s = 1.0 / (cut**3 + third)
        shield = s ** (1.0 / 3.0)
        return {"third": third, "level": shield - near, "slope": (near - bell * gauss) / cut - cut * cut * s * shield,
                "bend": -2.0 * (near - bell * gauss) / cut**2 + 2.0 * alpha**2 * bell * gauss
                + shield * s * cut * (4.0 * cut**3 * s - 2.0)}

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        self.unit_factor(c, units)
        full = {(i, j): self.ends(settings, c["data"][element[i]], c["data"][element[j]]) for i, j in filled}
        return pack_parts(self.parts, self.constants(settings), full, ntypes, lambda _: [settings["cut"]], False)

    def own_energy(self, settings, filled, ntypes, qqr2e):
        numbers = np.zeros((5, ntypes + 1))
        for t, element in enumerate(element_of(filled, ntypes)):
            if element is not None:
                p = next(iter(filled.values()))["data"][element]
                c, cut = self.ends(settings, p, p), settings["cut"]
                level = c["level"] - c["slope"] * cut + 0.5 * c["bend"] * cut * cut
                own = -qqr2e * (0.5 * level + settings["alpha"] / ROOT_PI)
                numbers[:, t] = p["chi"], 0.5 * p["eta"] + own, p["omega"], p["qmin"], p["qmax"]
        return numbers


def check(p) -> str:
    """What is wrong with the numbers of an element."""
    if not p["gamma"] > 0.0 or min(p["eta"], p["zeta"], p["Z"], p["omega"]) < 0.0:
        return "gamma must be positive, eta, zeta, Z and omega must not be negative"
    return "" if p["qmin"] <= p["qmax"] else "qmin must not be above qmax"


register(ChargeTransfer("coul/ctip", parts=[(coul_ctip, "cut")], rows="third level slope bend", settings="alpha cut",
                        settings_example="0.2 10.0", example="NiO.ctip Ni O", xfail=APPROXIMATE, converts=False, shifts=False, doc=__doc__,
                        see="LAMMPS manual, pair_style coul/ctip"))
