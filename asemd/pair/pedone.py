r"""$$E = \frac{C_0}{r^{12}} + D_0 \left[ e^{-2\alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right] \qquad r < r_c$$

Morse with a repulsive power, for oxides and silicate glasses; used together with a Coulomb style. ``pair_modify shift yes`` takes off the
energy at the cutoff with the opposite sign of the power, as LAMMPS does.
Pedone, Malavasi, Menziani, Cormack and Segre, J. Phys. Chem. B 110, 11780 (2006).
"""
from __future__ import annotations

import math

from asemd.pair.morse import morse
from asemd.pairstyle import PairStyle, pair


class PedonePair(PairStyle):
    """Has LAMMPS's shift of the energy."""

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, False)
        for (i, j), c in filled.items() if shift else ():
            tables.rows[1, i, j] = tables.rows[1, j, i] = morse(c["cut"], c["d0"], c["alpha"], c["r0"])[0] - c["c0"] / c["cut"] ** 12
        return tables


def pedone_d2(r, d0, alpha, r0, c0):
    x = math.exp(-alpha * (r - r0))
    return 2.0 * d0 * alpha * alpha * x * (2.0 * x - 1.0) + 156.0 * c0 / r**14


@pair("pedone", settings="cut", coeff="d0 alpha r0 c0 [cut]", settings_example="2.5", example="1.0 2.0 1.2 0.3 2.4", d2=pedone_d2,
      cls=PedonePair, see="LAMMPS manual, pair_style pedone")
def pedone(r, d0: "energy", alpha: "1/distance", r0: "distance", c0: "energy*distance^12"):
    rinv = 1.0 / r
    r3inv = rinv * rinv * rinv
    r6inv = r3inv * r3inv
    repulsion = c0 * r6inv * r6inv
    x = math.exp(-alpha * (r - r0))
    return repulsion + d0 * x * (x - 2.0), -12.0 * repulsion * rinv - 2.0 * d0 * alpha * x * (x - 1.0)
