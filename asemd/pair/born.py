r"""$$E = A e^{(\sigma - r)/\rho} - C / r^6 + D / r^8 \qquad r < r_c$$

Born, Mayer and Huggins, for ionic crystals and melts. Pairs of unlike types are given one by one.
Fumi and Tosi, J. Phys. Chem. Solids 25, 31 (1964).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import pair, power_tail


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair."""
    rho, x = c["rho"], cut / c["rho"]
    decay = 2.0 * math.pi * c["a"] * rho**3 * math.exp((c["sigma"] - cut) / rho)
    e, p = power_tail(((-c["c"], 6), (c["d"], 8)), cut)
    return e + decay * (2.0 + x * (2.0 + x)), p + decay * (6.0 + x * (6.0 + x * (3.0 + x))) / 3.0


def check(coeff, settings):
    if not coeff["rho"] > 0.0:
        raise InputError(f"pair_coeff born: rho must be > 0, got {coeff['rho']:g}")


def born_d2(r, a, rho, sigma, c, d):
    r2inv = 1.0 / (r * r)
    r6inv = r2inv * r2inv * r2inv
    return a * math.exp((sigma - r) / rho) / (rho * rho) - (42.0 * c - 72.0 * d * r2inv) * r6inv * r2inv


@pair("born", settings="cut", coeff="a rho sigma c d [cut]", tail=tail, check=check, settings_example="2.5", d2=born_d2,
      example="6.08 0.317 1.34 2.18 1.51 2.4", see="LAMMPS manual, pair_style born")
def born(r, a: "energy", rho: "distance", sigma: "distance", c: "energy*distance^6", d: "energy*distance^8"):
    rinv = 1.0 / r
    r2inv = rinv * rinv
    r6inv = r2inv * r2inv * r2inv
    repulsion = a * math.exp((sigma - r) / rho)
    near = d * r2inv
    return repulsion - (c - near) * r6inv, (6.0 * c - 8.0 * near) * r6inv * rinv - repulsion / rho


def near(r, r2, a, rho, sigma, c, d):
    """Of cores and shells: their powers take another distance."""
    r2inv = 1.0 / r2
    r6inv = r2inv * r2inv * r2inv
    repulsion = a * math.exp((sigma - r) / rho)
    close = d * r2inv
    return repulsion - (c - close) * r6inv, (6.0 * c - 8.0 * close) * r6inv / r - repulsion / rho


born.near = near
