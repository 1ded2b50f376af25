r"""$$E = -\tfrac{1}{2} K R_0^2 \ln\left[ 1 - \left(\frac{r}{R_0}\right)^2 \right]
    + 4 \epsilon \left[ \left(\frac{\sigma}{r}\right)^{12} - \left(\frac{\sigma}{r}\right)^6 \right] + \epsilon$$

Finitely extensible bond of bead-spring polymers; the second part ends at its minimum, $2^{1/6} \sigma$, where it is zero.
Source: Kremer and Grest, J. Chem. Phys. 92, 5057 (1990); LAMMPS manual, bond_style fene.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import bond


def check(coeff, settings):
    for name in ("R0", "sigma"):
        if not coeff[name] > 0.0:
            raise InputError(f"bond_coeff fene: {name} must be > 0, got {coeff[name]:g}")


def fene_d2(r, K, R0, epsilon, sigma):
    rest = (R0 - r) * (R0 + r)
    curvature = K * (R0 / rest) * (R0 / rest) * (R0 * R0 + r * r)
    s2 = (sigma / r) * (sigma / r)
    s6 = s2 * s2 * s2
    if s6 > 0.5:
        curvature += 4.0 * epsilon * s6 * (156.0 * s6 - 42.0) / (r * r)
    return curvature


@bond("fene", example="30.0 1.5 1.0 1.0", check=check, rest=lambda coeff: 0.97 * coeff["sigma"],
      domain="the bond must be longer than 0 and shorter than R0", d2=fene_d2)
def fene(r, K: "energy/distance^2", R0: "distance", epsilon: "energy", sigma: "distance"):
    if not 0.0 < r < R0:
        return math.inf, math.inf
    rest = (R0 - r) * (R0 + r)
    spring = K * R0 * R0
    slope = spring * r / rest
    inverse = 1.0 / r
    s = sigma * inverse
    s2 = s * s
    s6 = s2 * s2 * s2
    repulsion = 0.0
    if s6 > 0.5:
        slope -= 48.0 * epsilon * s6 * (s6 - 0.5) * inverse
        repulsion = 4.0 * epsilon * (s6 - 0.5) * (s6 - 0.5)
    x = r / R0
    return repulsion - 0.5 * spring * (math.log(rest / (R0 * R0)) if x > 0.5 else math.log1p(-x * x)), slope
