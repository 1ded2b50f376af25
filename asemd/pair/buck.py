r"""E = A exp(-r/rho) - C / r^6 for r < cut.  Close to r = 0 the second part wins: atoms that come too close fall into each other."""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import pair


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair."""
    a, rho, x = c["A"], c["rho"], cut / c["rho"]
    decay, rc3 = a * rho**3 * math.exp(-x), cut**3
    energy = 2.0 * math.pi * (decay * (2.0 + x * (2.0 + x)) - c["C"] / (3.0 * rc3))
    pressure = -2.0 / 3.0 * math.pi * (2.0 * c["C"] / rc3 - decay * (6.0 + x * (6.0 + x * (3.0 + x))))
    return energy, pressure


def check(coeff, settings):
    if not coeff["rho"] > 0.0:
        raise InputError(f"pair_coeff buck: rho must be > 0, got {coeff['rho']:g}")


def buck_d2(r, A, rho, C):
    return A / (rho * rho) * math.exp(-r / rho) - 42.0 * C / r**8


@pair("buck", settings="cut", coeff="A rho C [cut]", tail=tail, check=check, units={"C": "energy*distance^6"}, settings_example="2.5",
      example="100.0 0.3 20.0 2.4", see="LAMMPS manual, pair_style buck", d2=buck_d2)
def buck(r, A: "energy", rho: "distance", C: "energy*distance^6"):
    rinv = 1.0 / r
    r2inv = rinv * rinv
    attraction = C * r2inv * r2inv * r2inv
    repulsion = A * math.exp(-r / rho)
    return repulsion - attraction, 6.0 * attraction * rinv - repulsion / rho


def near(r, r2, A, rho, C):
    """Of cores and shells: the power takes another distance."""
    attraction = C / (r2 * r2 * r2)
    repulsion = A * math.exp(-r / rho)
    return repulsion - attraction, 6.0 * attraction / r - repulsion / rho


buck.near = near
