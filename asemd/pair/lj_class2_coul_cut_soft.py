r"""The sum of lj/class2/soft up to cut_lj and coul/cut/soft up to cut_coul, with one lambda; one cutoff given means both."""
from __future__ import annotations

from asemd.pair import coul_cut_soft, lj_class2_soft
from asemd.pair.lj_cut_coul_cut_soft import derived
from asemd.pairstyle import pair_sum

pair_sum("lj/class2/coul/cut/soft", (lj_class2_soft.lj_class2_soft, "cut_lj"), (coul_cut_soft.coul_soft, "cut_coul"),
         cls=lj_class2_soft.SoftClass2Pair, settings="n alphaLJ alphaC cut_lj [cut_coul]",
         coeff="epsilon sigma lambda [cut_lj] [cut_coul]", derived=derived, rows="front core weight gap", defaults={"cut_coul": "cut_lj"},
         mix={"epsilon": "sigma", "sigma": "distance"}, tail=lj_class2_soft.tail, units={"epsilon": "energy", "alphaC": "distance^2"},
         settings_example="2.0 0.5 5.0 8.0 10.0", example="0.1 3.0 0.7 7.0 9.0", see="LAMMPS manual, pair_style lj/class2/coul/cut/soft")
