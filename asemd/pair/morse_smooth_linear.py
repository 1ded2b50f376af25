r"""$$E = \phi(r) - \phi(r_c) - (r - r_c) \phi'(r_c), \qquad
    \phi = D_0 \left[ e^{-2\alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right] \qquad r < r_c$$

Morse with shifted force: energy and force end at zero."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def derived(c, settings):
    """Energy and slope at the cutoff."""
    x = math.exp(-c["alpha"] * (c["cut"] - c["r0"]))
    return {"end": c["d0"] * x * (x - 2.0), "slope": -2.0 * c["d0"] * c["alpha"] * x * (x - 1.0)}


def morse_smooth_linear_d2(r, d0, alpha, r0, cut, end, slope):
    x = math.exp(-alpha * (r - r0))
    return 2.0 * d0 * alpha * alpha * x * (2.0 * x - 1.0)


@pair("morse/smooth/linear", settings="cut", coeff="d0 alpha r0 [cut]", derived=derived, rows="end slope", d2=morse_smooth_linear_d2,
      shifts=False, settings_example="2.5", example="1.0 2.0 1.2 2.4", see="LAMMPS manual, pair_style morse/smooth/linear")
def morse_smooth_linear(r, d0: "energy", alpha: "1/distance", r0: "distance", cut: "distance", end, slope):
    x = math.exp(-alpha * (r - r0))
    return d0 * x * (x - 2.0) - end - (r - cut) * slope, -2.0 * d0 * alpha * x * (x - 1.0) - slope
