r"""E = 4 epsilon [(sigma/r)^12 - (sigma/r)^6] for r < cut.  sigma is where E crosses zero; the minimum is at 2^(1/6) sigma."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair (Sun, J. Phys. Chem. B 102, 7338 (1998), equation 5)."""
    s3, rc3 = c["sigma"] ** 3, cut**3
    x = s3 / rc3
    front = 8.0 * math.pi * c["epsilon"] * s3 * x / 9.0
    return front * (x * x - 3.0), 2.0 * front * (2.0 * x * x - 3.0)


def lj_cut_d2(r2, epsilon, sigma):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    return 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv


def lj_cut_alike(r2, epsilon, sigma):
    """`lj_cut` for coefficients that all pairs of types share: their powers are taken outside the loop over pairs."""
    r2inv = 1.0 / r2
    s3 = sigma * sigma * sigma
    c6 = 4.0 * epsilon * (s3 * s3)
    c12 = c6 * (s3 * s3)
    r4inv = r2inv * r2inv
    r6inv = r4inv * r2inv
    return r6inv * (c12 * r6inv - c6), r4inv * r4inv * (3.0 * c6 - 6.0 * c12 * r6inv)


@pair("lj/cut", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
      settings_example="2.5", example="1.0 1.1 2.4", see="LAMMPS manual, pair_style lj/cut", d2=lj_cut_d2, alike=lj_cut_alike,
      splits=True)
def lj_cut(r2, epsilon: "energy", sigma: "distance"):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = epsilon * s6
    return 4.0 * e * (s6 - 1.0), -12.0 * e * (2.0 * s6 - 1.0) * r2inv
