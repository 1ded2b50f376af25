r"""Bond angles of atoms without bonds that fade with distance: $E=K(\theta_{jik}-\theta_0)^2e^{-(r_{ij}/\rho_{ij}+r_{ik}/\rho_{ik})}$.

As `pair nb3b/harmonic`, with a length rho in each entry before the cutoff.
"""
from __future__ import annotations

import math

from asemd.pair.nb3b_harmonic import Angles, angles
from asemd.style import register


def fade(r, p):
    """A factor of the energy by distance, and minus the derivative of its logarithm."""
    return math.exp(-r * p[3]), p[3]


class Screened(Angles):
    names = "K theta0 rho cutoff"
    columns = ("cutoff", "K", "angle", "decay")

    def row(self, p, units):
        return {**super().row(p, units), "decay": 1.0 / p["rho"]}

    def check_entry(self, p, error):
        super().check_entry(p, error)
        if not p["rho"] > 0.0:
            raise error(f"rho must be positive, got {p['rho']:g}")


register(Screened("nb3b/screened", site=angles, helpers=(fade,), rooms=6, example="PSiO.nb3b.screened O", doc=__doc__,
                  see="M. Bertani, M. C. Menziani, A. Pedone, Phys. Rev. Mater. 5, 045602 (2021)"))
