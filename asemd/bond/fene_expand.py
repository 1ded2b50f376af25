r"""$$E = -\tfrac{1}{2} K R_0^2 \ln\left[ 1 - \left(\frac{r - \Delta}{R_0}\right)^2 \right]
    + 4 \epsilon \left[ \left(\frac{\sigma}{r - \Delta}\right)^{12} - \left(\frac{\sigma}{r - \Delta}\right)^6 \right] + \epsilon$$

The bond of style fene between beads whose size differs by $\Delta$; the second part ends where $r - \Delta$ is $2^{1/6} \sigma$.
Source: Kremer and Grest, J. Chem. Phys. 92, 5057 (1990); LAMMPS manual, bond_style fene/expand.
"""
from __future__ import annotations

import math

from asemd.style import bond


def fene_expand_d2(r, K, R0, epsilon, sigma, shift):
    d = r - shift
    rest = (R0 - d) * (R0 + d)
    curvature = K * (R0 / rest) * (R0 / rest) * (R0 * R0 + d * d)
    if sigma != 0.0:
        s2 = (sigma / d) * (sigma / d)
        s6 = s2 * s2 * s2
        if s6 > 0.5:
            curvature += 4.0 * epsilon * s6 * (156.0 * s6 - 42.0) / (d * d)
    return curvature


@bond("fene/expand", example="30.0 1.5 1.0 1.0 0.2", rest=lambda coeff: coeff["shift"] + 0.97 * coeff["sigma"],
      domain="r - shift must be shorter than R0 and, with repulsion, not 0", d2=fene_expand_d2)
def fene_expand(r, K: "energy/distance^2", R0: "distance", epsilon: "energy", sigma: "distance", shift: "distance"):
    d = r - shift
    rest = (R0 - d) * (R0 + d)
    if not rest > 0.0 or (d == 0.0 and sigma != 0.0):
        return math.inf, math.inf
    spring = K * R0 * R0
    slope = spring * d / rest
    repulsion = 0.0
    if sigma != 0.0:
        inverse = 1.0 / d
        s = sigma * inverse
        s2 = s * s
        s6 = s2 * s2 * s2
        if s6 > 0.5:
            slope -= 48.0 * epsilon * s6 * (s6 - 0.5) * inverse
            repulsion = 4.0 * epsilon * (s6 - 0.5) * (s6 - 0.5)
    x = d / R0
    return repulsion - 0.5 * spring * (math.log(rest / (R0 * R0)) if x * x > 0.25 else math.log1p(-x * x)), slope
