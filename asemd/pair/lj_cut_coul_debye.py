r"""The sum of lj/cut up to cut_lj and coul/debye up to cut_coul; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_debye import coul_debye
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/cut/coul/debye", (lj_cut, "cut_lj"), (coul_debye, "cut_coul"), settings="kappa cut_lj [cut_coul]",
         coeff="epsilon sigma [cut_lj] [cut_coul]", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"},
         tail=tail, settings_example="0.3 8.0 10.0", example="0.1 3.0 7.0 9.0", see="LAMMPS manual, pair_style lj/cut/coul/debye")
