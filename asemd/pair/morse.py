r"""E = D0 [exp(-2 alpha (r - r0)) - 2 exp(-alpha (r - r0))] for r < cut."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


@pair("morse", settings="cut", coeff="D0 alpha r0 [cut]", settings_example="2.5", example="1.0 2.0 1.2 2.4",
      see="LAMMPS manual, pair_style morse")
def morse(r, D0: "energy", alpha: "1/distance", r0: "distance"):
    x = math.exp(-alpha * (r - r0))
    return D0 * x * (x - 2.0), -2.0 * D0 * alpha * x * (x - 1.0)
