r"""$$E = 4\epsilon \left[ \left( \frac{\sigma}{r - \Delta} \right)^{12} - \left( \frac{\sigma}{r - \Delta} \right)^6 \right]
    \qquad r < r_c + \Delta$$

Lennard-Jones moved outward by delta, for particles of different sizes. The cutoff is counted from delta on. delta mixes as the mean of
both types. ``pair_modify shift yes`` takes off the energy that lj/cut has at rc + delta, as
LAMMPS does, which is not quite that at the end.
"""
from __future__ import annotations

import math

from asemd.pairstyle import PairStyle, pair


def tail(c, cut):
    """Energy and pressure integrals beyond `cut` (delta included) of one type pair."""
    delta, x, e, p = c["delta"], cut - c["delta"], 0.0, 0.0
    for front, n in ((4.0 * c["epsilon"] * c["sigma"] ** 12, 12), (-4.0 * c["epsilon"] * c["sigma"] ** 6, 6)):
        e += 2.0 * math.pi * front * sum(w * delta**k * x ** (3 - k - n) / (n - 3 + k) for k, w in enumerate((1, 2, 1)))
        p += 2.0 * math.pi / 3.0 * front * n * sum(w * delta**k * x ** (3 - k - n) / (n - 3 + k) for k, w in enumerate((1, 3, 3, 1)))
    return e, p


class ExpandPair(PairStyle):
    """Cutoffs are counted from delta on."""

    def cutoffs(self, coeff, settings):
        return [cut + coeff["delta"] for cut in super().cutoffs(coeff, settings)]

    def shift_at(self, coeff, settings) -> float:
        """The distance at which lj/cut has the energy that ``shift yes`` takes off."""
        return self.cutoffs(coeff, settings)[0]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, False)
        for (i, j), c in filled.items() if shift else ():
            end = lj_expand(self.shift_at(c, settings), c["epsilon"], c["sigma"], 0.0)[0]
            tables.rows[1, i, j] = tables.rows[1, j, i] = end
        return tables


def lj_expand_d2(r, epsilon, sigma, delta):
    xinv = 1.0 / (r - delta)
    s6 = (sigma * xinv) ** 6
    return 24.0 * epsilon * s6 * (26.0 * s6 - 7.0) * xinv * xinv


@pair("lj/expand", settings="cut", coeff="epsilon sigma delta [cut]", tail=tail, cls=ExpandPair, d2=lj_expand_d2,
      mix={"epsilon": "sigma", "sigma": "distance", "delta": "arithmetic"}, settings_example="2.5", example="1.0 1.1 -0.2 2.4",
      see="LAMMPS manual, pair_style lj/expand")
def lj_expand(r, epsilon: "energy", sigma: "distance", delta: "distance"):
    xinv = 1.0 / (r - delta)
    s = sigma * xinv
    s2 = s * s
    s6 = s2 * s2 * s2
    e = epsilon * s6
    return 4.0 * e * (s6 - 1.0), -24.0 * e * (2.0 * s6 - 1.0) * xinv
