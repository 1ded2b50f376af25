r"""$$E = D_0 \left[ e^{-2\alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right] - s_6 \frac{C_6}{r^6} f(r), \qquad
    f = \frac{1}{1 + e^{-d (r/R_r - 1)}} \qquad r < r_c$$

The many-body metal-organic force field: Morse and Grimme's damped dispersion, for molecules on silver. What ``pair_modify shift yes``
takes off is the Morse part of the energy at the cutoff, as in LAMMPS.
Zhou, Saidi and Fichthorn, J. Phys. Chem. C 118, 3366 (2014).
"""
from __future__ import annotations

import math

from asemd.pair.morse import morse
from asemd.pairstyle import PairStyle, pair


class MombPair(PairStyle):
    """Has LAMMPS's shift of the energy."""

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, False)
        for (i, j), c in filled.items() if shift else ():
            tables.rows[1, i, j] = tables.rows[1, j, i] = morse(c["cut"], c["D0"], c["alpha"], c["r0"])[0]
        return tables


def momb_d2(r, D0, alpha, r0, C6, Rr, s6, d):
    x = math.exp(-alpha * (r - r0))
    w = math.exp(-d * (r / Rr - 1.0))
    damp = 1.0 / (1.0 + w)
    rise = d / Rr * w * damp
    bend = rise * (rise - d / Rr * damp)
    dispersion = s6 * C6 / r**6 * damp
    return 2.0 * D0 * alpha * alpha * x * (2.0 * x - 1.0) - dispersion * (42.0 / (r * r) - 12.0 * rise / r + bend)


@pair("momb", settings="cut s6 d", coeff="D0 alpha r0 C6 Rr [cut]", settings_example="8.0 0.75 20.0", d2=momb_d2, cls=MombPair,
      example="0.1 1.2 3.5 40.0 3.2 7.5", see="LAMMPS manual, pair_style momb")
def momb(r, D0: "energy", alpha: "1/distance", r0: "distance", C6: "energy*distance^6", Rr: "distance", s6, d):
    rinv = 1.0 / r
    r2inv = rinv * rinv
    x = math.exp(-alpha * (r - r0))
    w = math.exp(-d * (r / Rr - 1.0))
    damp = 1.0 / (1.0 + w)
    dispersion = s6 * C6 * r2inv * r2inv * r2inv * damp
    return D0 * x * (x - 2.0) - dispersion, -2.0 * D0 * alpha * x * (x - 1.0) + dispersion * (6.0 * rinv - d / Rr * w * damp)
