r"""The sum of lj/cut up to cut_lj and coul/long/cs up to cut_coul, for cores and shells and a long-range solver; one cutoff given means
both."""
from __future__ import annotations

from asemd.pair.coul_long_cs import coul_long_cs
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/cut/coul/long/cs", (lj_cut, "cut_lj"), (coul_long_cs, "cut_coul"), settings="cut_lj [cut_coul]",
         defaults={"cut_coul": "cut_lj"}, coeff="epsilon sigma [cut_lj]", mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
         settings_example="8.0 10.0", example="0.1 3.0 7.0", see="LAMMPS manual, pair_style lj/cut/coul/long/cs")
