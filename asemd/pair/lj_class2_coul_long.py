r"""The sum of lj/class2 up to cut_lj and coul/long up to cut_coul, for a long-range solver; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_long import coul_long
from asemd.pair.lj_class2 import Class2Pair, lj_class2, tail
from asemd.pairstyle import pair_sum

OPTIONS = dict(cls=Class2Pair, settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]", defaults={"cut_coul": "cut_lj"}, tail=tail,
               mix={"epsilon": "sigma", "sigma": "distance"}, settings_example="8.0 10.0", example="0.1 3.0 7.0")
pair_sum("lj/class2/coul/long", (lj_class2, "cut_lj"), (coul_long, "cut_coul"), splits=True,
         see="LAMMPS manual, pair_style lj/class2/coul/long", **OPTIONS)
