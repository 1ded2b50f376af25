r"""$$E = \left[ A / r^{12} - B / r^6 \right] f(r)$$

Lennard-Jones given by the factors of both powers, times the taper of lj/mdf between inner and outer.
"""
from __future__ import annotations

import math

from asemd.pair.lj_mdf import TaperedPair
from asemd.pairstyle import pair


def lennard_mdf_d2(r2, a, b, inner, outer):
    r2inv = 1.0 / r2
    r6inv = r2inv * r2inv * r2inv
    e, slope = r6inv * (a * r6inv - b), -3.0 * r6inv * (2.0 * a * r6inv - b) * r2inv
    curve = r6inv * (42.0 * a * r6inv - 12.0 * b) * r2inv * r2inv
    r = math.sqrt(r2)
    if r <= inner:
        return curve
    w = outer - inner
    x, gap = (r - inner) / w, (outer - r) / w
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    fall = -15.0 * x * x * gap * gap / (w * r)
    bend = -0.5 * fall * r2inv - 15.0 * x * gap * (gap - x) / (w * w * r2)
    return curve * taper + 2.0 * slope * fall + e * bend


@pair("lennard/mdf", settings="inner outer", coeff="a b [inner] [outer]", cut="outer", cls=TaperedPair, shifts=False, d2=lennard_mdf_d2,
      settings_example="2.0 2.5", example="12.0 7.0 1.9 2.4", see="LAMMPS manual, pair_style lennard/mdf")
def lennard_mdf(r2, a: "energy*distance^12", b: "energy*distance^6", inner: "distance", outer: "distance"):
    r2inv = 1.0 / r2
    r6inv = r2inv * r2inv * r2inv
    near = a * r6inv
    e = r6inv * (near - b)
    slope = -3.0 * r6inv * (2.0 * near - b) * r2inv
    r = math.sqrt(r2)
    winv = 1.0 / (outer - inner)
    x = (r - inner) * winv if r > inner else 0.0
    gap = (outer - r) * winv if r > inner else 1.0
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    fall = -15.0 * x * x * gap * gap * winv * r * r2inv
    return e * taper, slope * taper + e * fall
