r"""The sum of lj/class2 up to cut_lj and coul/long/cs up to cut_coul, for cores and shells and a long-range solver; one cutoff given means
both."""
from __future__ import annotations

from asemd.pair.coul_long_cs import coul_long_cs
from asemd.pair.lj_class2 import lj_class2
from asemd.pair.lj_class2_coul_long import OPTIONS
from asemd.pairstyle import pair_sum

pair_sum("lj/class2/coul/long/cs", (lj_class2, "cut_lj"), (coul_long_cs, "cut_coul"),
         see="LAMMPS manual, pair_style lj/class2/coul/long/cs", **OPTIONS)
