r"""E = 4 epsilon [(sigma/r)^9 - (sigma/r)^6] for r < cut.  sigma is where E crosses zero."""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` of one type pair (Sun, J. Phys. Chem. B 102, 7338 (1998), equation 5)."""
    s3, rc3 = c["sigma"] ** 3, cut**3
    x = s3 / rc3
    front = 8.0 * math.pi * c["epsilon"] * s3 * x / 6.0
    return front * (x - 2.0), front * (3.0 * x - 4.0)


def lj96_cut_d2(r2, epsilon, sigma):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s3 = s2 * math.sqrt(s2)
    return 3.0 * epsilon * s3 * s3 * (33.0 * s3 - 16.0) * r2inv * r2inv


@pair("lj96/cut", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
      settings_example="2.5", example="1.0 1.1 2.4", see="LAMMPS manual, pair_style lj96/cut", d2=lj96_cut_d2,
      splits=True)
def lj96_cut(r2, epsilon: "energy", sigma: "distance"):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s3 = s2 * math.sqrt(s2)
    s6 = s3 * s3
    e = epsilon * s6
    return 4.0 * e * (s3 - 1.0), -6.0 * e * (3.0 * s3 - 2.0) * r2inv
