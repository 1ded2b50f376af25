r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] f(r), \qquad f = (1 - x)^3 (1 + 3x + 6x^2), \;\;
    x = \frac{r - r_m}{r_c - r_m} \;\; (r > r_m), \quad 1 \;\; (r \le r_m)$$

Lennard-Jones times the taper of Mei, Davenport and Fernando between inner (rm) and outer (rc): energy, force and its derivative end at
zero.  Phys. Rev. B 43, 4653 (1991).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.lj_gromacs import SwitchedPair
from asemd.pairstyle import pair


class TaperedPair(SwitchedPair):
    """The inner cutoff of single pairs may be 0, as in LAMMPS."""

    positive = False

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if values["inner"] == 0.0:
            raise InputError(f"pair_style {self.name}: inner must be greater than 0, got {words[0]}")
        return values


def lj_mdf_d2(r2, epsilon, sigma, inner, outer):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e, slope = 4.0 * epsilon * s6 * (s6 - 1.0), -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv
    curve = 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv
    r = math.sqrt(r2)
    if r <= inner:
        return curve
    w = outer - inner
    x, gap = (r - inner) / w, (outer - r) / w
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    fall = -15.0 * x * x * gap * gap / (w * r)
    bend = -0.5 * fall * r2inv - 15.0 * x * gap * (gap - x) / (w * w * r2)
    return curve * taper + 2.0 * slope * fall + e * bend


@pair("lj/mdf", settings="inner outer", coeff="epsilon sigma [inner] [outer]", cut="outer", cls=TaperedPair, shifts=False, d2=lj_mdf_d2,
      mix={"epsilon": "sigma", "sigma": "distance", "inner": "distance", "outer": "distance"}, settings_example="2.0 2.5",
      example="1.0 1.1 1.9 2.4", see="LAMMPS manual, pair_style lj/mdf")
def lj_mdf(r2, epsilon: "energy", sigma: "distance", inner: "distance", outer: "distance"):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = 4.0 * epsilon * s6 * (s6 - 1.0)
    slope = -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv
    r = math.sqrt(r2)
    winv = 1.0 / (outer - inner)
    x = (r - inner) * winv if r > inner else 0.0
    gap = (outer - r) * winv if r > inner else 1.0
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    fall = -15.0 * x * x * gap * gap * winv * r * r2inv
    return e * taper, slope * taper + e * fall
