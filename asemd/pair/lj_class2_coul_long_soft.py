r"""The sum of lj/class2/soft up to cut_lj and coul/long/soft up to cut_coul, with one lambda, for a long-range solver; one cutoff given
means both. Force of coul/long/soft: see there. ``pair_modify shift yes`` takes off the energy at the cutoff without the factor lambda^n, as
LAMMPS does."""
from __future__ import annotations

from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.pair.lj_class2_soft import SoftClass2Pair, lj_class2_soft, tail
from asemd.pair.lj_cut_coul_long_soft import OPTIONS as SOFT
from asemd.pairstyle import pair_sum


class SoftClass2LongPair(SoftClass2Pair):
    """Has LAMMPS's shift of the energy."""

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, shift)
        for (i, j), c in filled.items() if shift else ():
            cut, core = self.cutoffs(c, settings)[0], settings["alphaLJ"] * (1.0 - c["lambda"]) ** 2
            tables.rows[1, i, j] = tables.rows[1, j, i] = lj_class2_soft(cut * cut, c["epsilon"], core, c["sigma"])[0]
        return tables


OPTIONS = SOFT | dict(tail=tail, see="LAMMPS manual, pair_style lj/class2/coul/long/soft")
style = pair_sum("lj/class2/coul/long/soft", (lj_class2_soft, "cut_lj"), (coul_long_soft, "cut_coul"), cls=SoftClass2LongPair, **OPTIONS)
style.twin = SoftClass2LongPair("lj/class2/coul/long/soft", [(lj_class2_soft, "cut_lj"), (coul_long_soft_lammps, "cut_coul")], doc=__doc__,
                            **OPTIONS)
