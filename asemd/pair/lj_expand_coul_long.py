r"""The sum of lj/expand up to cut_lj + delta and coul/long up to cut_coul, for a long-range solver; one cutoff given means both.

``pair_modify shift yes`` takes off the energy that lj/cut has at cut_lj, as LAMMPS does."""
from __future__ import annotations

from asemd.pair.coul_long import coul_long
from asemd.pair.lj_expand import ExpandPair, lj_expand, tail
from asemd.pairstyle import PairStyle, pair_sum


class ExpandSum(ExpandPair):
    """Only the first cutoff is counted from delta on."""

    def cutoffs(self, coeff, settings):
        lj, coul = PairStyle.cutoffs(self, coeff, settings)
        return [lj + coeff["delta"], coul]

    def shift_at(self, coeff, settings):
        return PairStyle.cutoffs(self, coeff, settings)[0]


pair_sum("lj/expand/coul/long", (lj_expand, "cut_lj"), (coul_long, "cut_coul"), cls=ExpandSum, settings="cut_lj [cut_coul]",
         coeff="epsilon sigma delta [cut_lj]", defaults={"cut_coul": "cut_lj"}, tail=tail,
         mix={"epsilon": "sigma", "sigma": "distance", "delta": "arithmetic"}, settings_example="8.0 10.0", example="0.1 3.0 -0.2 7.0",
         splits=True, see="LAMMPS manual, pair_style lj/expand/coul/long")
