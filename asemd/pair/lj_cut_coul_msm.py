r"""The sum of lj/cut up to cut_lj and coul/msm up to cut_coul, for multilevel summation; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_msm import coul_msm
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/cut/coul/msm", (lj_cut, "cut_lj"), (coul_msm, "cut_coul"), settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]",
         defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, splits=True,
         settings_example="8.0 10.0", example="0.1 3.0 7.0", see="LAMMPS manual, pair_style lj/cut/coul/msm")
