r"""$$E = D \left[ 1 - e^{-\alpha (r - r_0)} \right]^2$$

Anharmonic bond that breaks softly: D is the depth of the well, alpha its stiffness. Source: LAMMPS manual, bond_style morse.
"""
from __future__ import annotations

import math

from asemd.style import bond


def morse_d2(r, D, alpha, r0):
    x = math.exp(-alpha * (r - r0))
    return 2.0 * D * alpha * alpha * x * (2.0 * x - 1.0)


@bond("morse", example="80.0 1.2 1.5", equilibrium="r0", d2=morse_d2)
def morse(r, D: "energy", alpha: "1/distance", r0: "distance"):
    y = -alpha * (r - r0)
    if y > 350.0:       # the energy overflows
        return math.inf, math.inf
    b = -math.expm1(y)
    return D * b * b, 2.0 * D * alpha * b * math.exp(y)
