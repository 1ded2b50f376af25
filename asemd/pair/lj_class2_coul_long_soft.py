r"""The sum of lj/class2/soft up to cut_lj and coul/long/soft up to cut_coul, with one lambda, for a long-range solver; one cutoff given
means both. Force of coul/long/soft: see there."""
from __future__ import annotations

from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.pair.lj_class2_soft import SoftClass2Pair, lj_class2_soft, tail
from asemd.pair.lj_cut_coul_long_soft import OPTIONS as SOFT
from asemd.pairstyle import pair_sum

OPTIONS = SOFT | dict(tail=tail, see="LAMMPS manual, pair_style lj/class2/coul/long/soft")
style = pair_sum("lj/class2/coul/long/soft", (lj_class2_soft, "cut_lj"), (coul_long_soft, "cut_coul"), cls=SoftClass2Pair, **OPTIONS)
style.twin = SoftClass2Pair("lj/class2/coul/long/soft", [(lj_class2_soft, "cut_lj"), (coul_long_soft_lammps, "cut_coul")], doc=__doc__,
                            **OPTIONS)
