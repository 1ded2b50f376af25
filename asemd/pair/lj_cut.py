r"""E = 4 epsilon [(sigma/r)^12 - (sigma/r)^6] for r < cut.  sigma is where E crosses zero; the minimum is at 2^(1/6) sigma."""
from __future__ import annotations

import math

import numpy as np

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


def powers(epsilon, sigma):
    """Factors of the twelfth and the sixth power of 1/r in the force by r^2."""
    s6 = sigma**6
    return 48.0 * epsilon * s6 * s6, 24.0 * epsilon * s6


def small_powers(epsilon, sigma):
    """The same for single precision; None for numbers that have no room there, as those of ``units si``."""
    found = powers(epsilon, sigma)
    used = np.abs(np.concatenate([x[x != 0.0] for x in found]))
    return found if np.all((used > 1e-20) & (used < 1e20)) else None


def lj_cut_powers(r2, a12, a6):
    """`lj_cut` by the numbers of `powers`."""
    r2inv = 1.0 / r2
    r6inv = r2inv * r2inv * r2inv
    return r6inv * (a12 * r6inv - 2.0 * a6) * (1.0 / 12.0), -0.5 * r2inv * r6inv * (a12 * r6inv - a6)


@pair("lj/cut", settings="cut", coeff="epsilon sigma [cut]", mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
      settings_example="2.5", example="1.0 1.1 2.4", see="LAMMPS manual, pair_style lj/cut", d2=lj_cut_d2, splits=True)
def lj_cut(r2, epsilon: "energy", sigma: "distance"):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = epsilon * s6
    return 4.0 * e * (s6 - 1.0), -12.0 * e * (2.0 * s6 - 1.0) * r2inv


lj_cut.powers = {False: ((lj_cut_powers, powers),), True: ((lj_cut_powers, small_powers),)}
