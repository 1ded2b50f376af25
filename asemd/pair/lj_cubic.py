r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] \;\; (r \le r_s), \qquad
    E = \frac{133 \epsilon}{338 w^3} (r_c - r)^2 (r_c - r - 3w) \;\; (r_s < r < r_c)$$

Lennard-Jones up to its inflection point rs = (26/7)^(1/6) sigma, from there on the cubic polynomial that continues energy, force and its
derivative and ends with energy and force zero at rc = (67/48) rs; w = rc - rs.  Holian and Ravelo, Phys. Rev. B 51, 11275 (1995).
"""
from __future__ import annotations

import math

from asemd.pairstyle import PairStyle, pair

INFLECTION = (26.0 / 7.0) ** (1.0 / 6.0)


def derived(c, settings):
    """The inflection point, the cutoff, and the factor of the cubic polynomial."""
    rs = c["sigma"] * INFLECTION
    return {"inner": rs, "end": 67.0 / 48.0 * rs, "front": 133.0 / 338.0 * c["epsilon"] / (19.0 / 48.0 * rs) ** 3}


class CubicPair(PairStyle):
    """The cutoff follows from sigma."""

    def cutoffs(self, coeff, settings):
        return [67.0 / 48.0 * INFLECTION * coeff["sigma"]]


def lj_cubic_d2(r2, epsilon, sigma, inner, end, front):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    r = math.sqrt(r2)
    u, w = end - r, end - inner
    slope, curve = 3.0 * front * u * (2.0 * w - u), 6.0 * front * (u - w)
    return 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv if r <= inner else 0.25 * (curve - slope / r) * r2inv


@pair("lj/cubic", coeff="epsilon sigma", derived=derived, rows="inner end front", cls=CubicPair, shifts=False, d2=lj_cubic_d2,
      mix={"epsilon": "sigma", "sigma": "distance"}, example="1.0 1.1", see="LAMMPS manual, pair_style lj/cubic")
def lj_cubic(r2, epsilon: "energy", sigma: "distance", inner, end, front):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = epsilon * s6
    r = math.sqrt(r2)
    u = end - r
    w = end - inner
    near = r <= inner
    far = front * u * u * (u - 3.0 * w)
    slope = 1.5 * front * u * (2.0 * w - u) * r * r2inv
    return (4.0 * e * (s6 - 1.0) if near else far), (-12.0 * e * (2.0 * s6 - 1.0) * r2inv if near else slope)
