r"""The sum of lj/cut up to cut_lj and coul/dsf up to cut_coul; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_dsf import APPROXIMATE, ForceShiftedSum, coul_dsf
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/cut/coul/dsf", (lj_cut, "cut_lj"), (coul_dsf, "cut_coul"), cls=ForceShiftedSum, settings="alpha cut_lj [cut_coul]",
         coeff="epsilon sigma [cut_lj]", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
         settings_example="0.2 8.0 10.0", example="0.1 3.0 7.0", xfail=APPROXIMATE, see="LAMMPS manual, pair_style lj/cut/coul/dsf")
