r"""What special_bonds takes off the Coulomb energy of special pairs: E = -(1 - weight) C q_i q_j / (dielectric r) for r < cut.

For a long-range solver whose real-space part is not among the pair styles, or is computed elsewhere; other pairs do not interact.
"""
from __future__ import annotations

from asemd.pair.coul_wolf import bare_special
from asemd.pairstyle import PairStyle, pair


class SpecialPair(PairStyle):
    """Only special pairs interact."""

    special_only = True


def nothing(r2, qq):
    return 0.0 * qq


@pair("coul/exclude", cls=SpecialPair, settings="cut", coeff="", settings_example="10.0", example="", d2=nothing,
      see="LAMMPS manual, pair_style coul/exclude")
@bare_special
def coul_exclude(r2, qq):
    return 0.0 * qq, 0.0 * r2
