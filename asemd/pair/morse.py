r"""E = D0 [exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0))] for r < cut."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def morse_d2(r, D0, alpha, r0):
    x = math.exp(-alpha * (r - r0))
    return 2.0 * D0 * alpha * alpha * x * (2.0 * x - 1.0)


@pair("morse", settings="cut", coeff="D0 alpha r0 [cut]", settings_example="2.5", example="1.0 2.0 1.2 2.4",
      see="LAMMPS manual, pair_style morse", d2=morse_d2)
def morse(r, D0: "energy", alpha: "1/distance", r0: "distance"):
    x = math.exp(-alpha * (r - r0))
    return D0 * x * (x - 2.0), -2.0 * D0 * alpha * x * (x - 1.0)
