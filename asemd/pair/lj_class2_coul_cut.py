r"""The sum of lj/class2 up to cut_lj and coul/cut up to cut_coul; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_cut import coul_cut
from asemd.pair.lj_class2 import Class2Pair, lj_class2, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/class2/coul/cut", (lj_class2, "cut_lj"), (coul_cut, "cut_coul"), cls=Class2Pair, settings="cut_lj [cut_coul]",
         coeff="epsilon sigma [cut_lj] [cut_coul]", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"},
         tail=tail, settings_example="8.0 10.0", example="0.1 3.0 7.0 9.0", see="LAMMPS manual, pair_style lj/class2/coul/cut")
