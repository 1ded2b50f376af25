r"""$$E = \left[ A e^{-r/\rho} - C / r^6 \right] f(r)$$

Buckingham (buck) times the taper of lj/mdf between inner and outer.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.lj_mdf import TaperedPair
from asemd.pairstyle import pair


def check(coeff, settings):
    if not coeff["rho"] > 0.0:
        raise InputError(f"pair_coeff buck/mdf: rho must be > 0, got {coeff['rho']:g}")


def buck_mdf_d2(r, a, rho, c, inner, outer):
    repulsion, attraction = a * math.exp(-r / rho), c / r**6
    e, slope = repulsion - attraction, 6.0 * attraction / r - repulsion / rho
    curve = repulsion / (rho * rho) - 42.0 * attraction / (r * r)
    if r <= inner:
        return curve
    w = outer - inner
    x, gap = (r - inner) / w, (outer - r) / w
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    return curve * taper - 60.0 * slope * x * x * gap * gap / w - 60.0 * e * x * gap * (gap - x) / (w * w)


@pair("buck/mdf", settings="inner outer", coeff="a rho c [inner] [outer]", cut="outer", cls=TaperedPair, shifts=False, check=check,
      d2=buck_mdf_d2, settings_example="2.0 2.5", example="100.0 0.3 20.0 1.9 2.4", see="LAMMPS manual, pair_style buck/mdf")
def buck_mdf(r, a: "energy", rho: "distance", c: "energy*distance^6", inner: "distance", outer: "distance"):
    rinv = 1.0 / r
    r2inv = rinv * rinv
    attraction = c * r2inv * r2inv * r2inv
    repulsion = a * math.exp(-r / rho)
    e = repulsion - attraction
    slope = 6.0 * attraction * rinv - repulsion / rho
    winv = 1.0 / (outer - inner)
    x = (r - inner) * winv if r > inner else 0.0
    gap = (outer - r) * winv if r > inner else 1.0
    taper = gap * gap * gap * (1.0 + x * (3.0 + 6.0 * x))
    return e * taper, slope * taper - 30.0 * e * x * x * gap * gap * winv
