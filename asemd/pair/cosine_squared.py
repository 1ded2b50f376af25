r"""$$E = -\epsilon \cos^2 \left( \frac{\pi (r - \sigma)}{2 (r_c - \sigma)} \right) \;\; (\sigma \le r < r_c), \qquad
    E = -\epsilon \;\; (r < \sigma)$$

A well of any width, for coarse-grained lipids. With the word ``wca`` the repulsion epsilon [(sigma/r)^12 - 2 (sigma/r)^6] stands inside
sigma; if the cutoff is sigma, that alone, moved up to end at zero. Written with a power series of the sine, as in soft, so that no digits
cancel near the cutoff.  Cooke and Deserno, J. Chem. Phys. 123, 224710 (2005).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair


def derived(c, settings):
    """Whether there is a repulsion inside sigma, how far it is moved up, and the inverse of the width of the well."""
    width, wca = c["cut"] - c["sigma"], "wca" in c
    return {"repulsive": float(wca), "lift": 0.0 if width else c["epsilon"], "steep": 1.0 / width if width else 0.0}


class CosineSquaredPair(PairStyle):
    """The word wca stands last, with or without a cutoff before it."""

    def parse_coeff(self, words, settings):
        what, wca = f"pair_coeff {self.name}", words[-1:] == ["wca"]
        values = self._read(words[:-1] if wca else words, self.coeff[:-1], "pair_coeff") | ({"wca": "wca"} if wca else {})
        cut = values.get("cut", settings["cut"])
        if not 0.0 < values["sigma"] <= cut:
            raise InputError(f"{what}: sigma = {values['sigma']:g} must be more than 0 and not more than the cutoff {cut:g}")
        if values["sigma"] == cut and not wca:
            raise InputError(f"{what}: the cutoff {cut:g} is sigma, which needs the word wca")
        return values


def cosine_squared_d2(r2, epsilon, sigma, cut, repulsive, lift, steep):
    r = math.sqrt(r2)
    if r < sigma:
        s6 = (sigma * sigma / r2) ** 3
        return repulsive * 6.0 * epsilon * s6 * (7.0 * s6 - 4.0) / (r2 * r2)
    k = 3.141592653589793 * steep
    slope, curve = 0.5 * epsilon * k * math.sin(k * (r - sigma)), 0.5 * epsilon * k * k * math.cos(k * (r - sigma))
    return 0.25 * (curve - slope / r) / r2


@pair("cosine/squared", settings="cut", coeff="epsilon sigma [cut] [wca]", derived=derived, rows="repulsive lift steep",
      cls=CosineSquaredPair, units={"wca": "word"}, shifts=False, settings_example="2.5", example="1.0 1.1 2.4 wca",
      d2=cosine_squared_d2, see="LAMMPS manual, pair_style cosine/squared")
def cosine_squared(r2, epsilon: "energy", sigma: "distance", cut: "distance", repulsive, lift, steep):
    r2inv = 1.0 / r2
    r = math.sqrt(r2)
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    near = r < sigma
    gap = (cut - r) * steep
    u = (r - sigma) * steep
    half = 0.5 * gap
    w = half * half
    sine = 5.392664662608129e-10 * w - 2.2948428997269873e-08
    sine = (sine * w + 7.952054001475513e-07) * w - 2.1915353447830217e-05
    sine = (sine * w + 0.00046630280576761255) * w - 0.0073704309457143504
    sine = (sine * w + 0.08214588661112823) * w - 0.5992645293207921
    sine = (sine * w + 2.5501640398773455) * w - 5.16771278004997
    sine = sine * w + 3.141592653589793
    root = half * sine
    side = u if u < gap else gap
    w = side * side
    slope = 5.392664662608129e-10 * w - 2.2948428997269873e-08
    slope = (slope * w + 7.952054001475513e-07) * w - 2.1915353447830217e-05
    slope = (slope * w + 0.00046630280576761255) * w - 0.0073704309457143504
    slope = (slope * w + 0.08214588661112823) * w - 0.5992645293207921
    slope = (slope * w + 2.5501640398773455) * w - 5.16771278004997
    slope = 0.7853981633974483 * epsilon * steep * side * (slope * w + 3.141592653589793) * r * r2inv
    core = repulsive * (epsilon * s6 * (s6 - 2.0) + lift) - (1.0 - repulsive) * epsilon
    push = repulsive * -6.0 * epsilon * s6 * (s6 - 1.0) * r2inv
    return (core if near else -epsilon * root * root), (push if near else slope)
