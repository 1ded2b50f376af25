r"""$$E = 4\epsilon\left[\frac{\sigma^{12}}{r^{12}} - \frac{\sigma^6}{r^6} + \left(\frac{6\sigma^{12}}{a^{12}}
    - \frac{3\sigma^6}{a^6}\right) \frac{r^2}{a^2}
     - \frac{7\sigma^{12}}{a^{12}} + \frac{4\sigma^6}{a^6}\right] + s C \left[q_i q_j \frac{(1-x)^2}{r}
    + (q_i \vec p_j - q_j \vec p_i) \cdot \vec r \frac{1 - 3 x^2 + 2 x^3}{r^3}
    + \left(\vec p_i \cdot \vec p_j - \frac{3 (\vec p_i \cdot \vec r)(\vec p_j \cdot \vec r)}{r^2}\right)
    \frac{1 - 4 x^3 + 3 x^4}{r^3}\right]$$

Lennard-Jones, charges and point dipoles with energies and forces that end at zero, at a = cut_lj and cut_coul; x = r / cut_coul, and
vec r = x_i - x_j. The factor s is 1 unless ``scale`` says otherwise. Dipoles feel torques.
Source: M. P. Allen, G. Germano, Mol. Phys. 104, 3225 (2006); S. D. Stoddard, J. Ford, Phys. Rev. A 8, 1504 (1973).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.lj_cut_dipole_cut import DipolePair
from asemd.style import register
from asemd.words import number


def derived(c, settings):
    """Both powers at the cutoff."""
    s6 = (c["sigma"] / c["cut_lj"]) ** 6 if c["cut_lj"] > 0.0 else 0.0
    return {"repulsion": 4.0 * c["epsilon"] * s6 * s6, "attraction": 4.0 * c["epsilon"] * s6}


def lj_shifted_d2(r2, repulsion, attraction, cut_lj):
    u3 = (cut_lj * cut_lj / r2) ** 3
    return (42.0 * repulsion * u3 - 12.0 * attraction) * u3 / (r2 * r2)


def lj_shifted(r2, repulsion: "energy", attraction: "energy", cut_lj: "distance"):
    """No digits cancel at the cutoff: both brackets are divided by the square of u - 1."""
    u = cut_lj * cut_lj / r2
    gap = (cut_lj * cut_lj - r2) / r2
    low = 6.0 + u * (5.0 + u * (4.0 + u * (3.0 + u * (2.0 + u))))
    seven = 1.0 + u * (1.0 + u * (1.0 + u * (1.0 + u * (1.0 + u * (1.0 + u)))))
    w = gap / u
    e = w * gap * (repulsion * low - attraction * (3.0 + u * (2.0 + u)))
    return e, -w / r2 * (6.0 * repulsion * seven - 3.0 * attraction * (1.0 + u) * (1.0 + u * u))


def coul_shifted_d2(r2, qq, cut_coul, scale):
    return scale * qq / (4.0 * r2 * math.sqrt(r2)) * (3.0 / r2 - 1.0 / (cut_coul * cut_coul))


def coul_shifted(r2, qq, cut_coul: "distance", scale: ""):
    r = math.sqrt(r2)
    gap = (cut_coul - r) / cut_coul
    e = scale * qq / r
    return e * gap * gap, -0.5 * e * gap * (cut_coul + r) / (cut_coul * r2)


lj_shifted.d2, coul_shifted.d2 = lj_shifted_d2, coul_shifted_d2


def radial(r2, whole, weight, cut2, constants):
    r, cut = math.sqrt(r2), math.sqrt(cut2)
    rinv = 1.0 / r
    x = r / cut
    gap = (cut - r) / cut
    b1 = weight * rinv
    b3 = b1 * rinv * rinv
    b5 = 3.0 * b3 * rinv * rinv
    f2 = b3 * gap * gap * (1.0 + x * (2.0 + 3.0 * x))
    g1 = b5 * gap * (1.0 + x)
    g2 = g1 * (1.0 + x * x)
    f3 = 3.0 * f2 * rinv * rinv
    return (b1 * gap * gap, b3 * gap * gap * (1.0 + 2.0 * x), f2, f3,
            b3 * gap * (1.0 + x), g1, g2, (3.0 * g2 + 2.0 * f3) * rinv * rinv)


class ShiftedDipoles(DipolePair):
    """With ``scale``, a word of ``pair_coeff`` that may come after the cutoffs, with the factor behind it."""

    def parse_coeff(self, words, settings):
        at = words.index("scale") if "scale" in words else len(words)
        if len(words) == at + 1:
            raise InputError(f"pair_coeff {self.name}: scale needs a number")
        if len(words) > at + 2:
            raise InputError(f"pair_coeff {self.name}: nothing may follow scale and its number, got {' '.join(words[at + 2:])}")
        values = super().parse_coeff(words[:at], settings)
        return values | {"scale": number(words[at + 1], f"pair_coeff {self.name}: scale") if words[at:] else 1.0}

    def format_coeff(self, coeff):
        return super().format_coeff(coeff) + (["scale", repr(coeff["scale"])] if coeff.get("scale", 1.0) != 1.0 else [])

    def mixed(self, a, b, rule):
        return super().mixed(a, b, rule) | {"scale": 1.0}


register(ShiftedDipoles("lj/sf/dipole/sf", radial, coul_shifted, __doc__, plain=lj_shifted, rows="repulsion attraction scale",
                        derived=derived, units={"epsilon": "energy", "sigma": "distance"}, shifts=False))
