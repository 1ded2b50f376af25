r"""$$E = -\tfrac{1}{2} K R_0^2 \ln\left[ 1 - \left(\frac{r}{R_0}\right)^2 \right]
    + \frac{E_0}{n - m} \left[ m \left(\frac{r_0}{r}\right)^n - n \left(\frac{r_0}{r}\right)^m \right]$$

The bond of style fene with a Lennard-Jones part of other exponents, which acts below its minimum $r_0$ only. It is not shifted: the
energy drops by $E_0$ where a bond becomes shorter than $r_0$, the force is continuous.
Source: LAMMPS manual, bond_style fene/nm.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import bond


def check(coeff, settings):
    if coeff["r0"] < 0.0:
        raise InputError(f"bond_coeff fene/nm: r0 must not be negative, got {coeff['r0']:g}")
    if coeff["n"] == coeff["m"]:
        raise InputError(f"bond_coeff fene/nm: n and m must be different, both are {coeff['n']:g}")


def fene_nm_d2(r, K, R0, E0, r0, n, m):
    rest = (R0 - r) * (R0 + r)
    curvature = K * (R0 / rest) * (R0 / rest) * (R0 * R0 + r * r)
    if r < r0:
        s = r0 / r
        curvature += E0 * n * m / (n - m) * ((n + 1.0) * s**n - (m + 1.0) * s**m) / (r * r)
    return curvature


@bond("fene/nm", example="30.0 1.5 1.0 1.12246 12 6", check=check, rest=lambda coeff: 0.97 * coeff["r0"],
      domain="the bond must be longer than 0 and shorter than R0", d2=fene_nm_d2)
def fene_nm(r, K: "energy/distance^2", R0: "distance", E0: "energy", r0: "distance", n: "", m: ""):
    rest = (R0 - r) * (R0 + r)
    if not (rest > 0.0 and r > 0.0):
        return math.inf, math.inf
    spring = K * R0 * R0
    slope = spring * r / rest
    repulsion = 0.0
    if r < r0:
        s = r0 / r
        low = s**m
        k = n - m
        # near the minimum the two powers are nearly equal
        more = math.expm1(k * math.log1p((r0 - r) / r)) if s < 1.5 else s**k - 1.0
        slope -= E0 * n * m / k * low * more / r
        repulsion = E0 * low * (m * more / k - 1.0)
    x = r / R0
    return repulsion - 0.5 * spring * (math.log(rest / (R0 * R0)) if x * x > 0.25 else math.log1p(-x * x)), slope
