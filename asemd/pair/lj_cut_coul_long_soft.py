r"""The sum of lj/cut/soft up to cut_lj and coul/long/soft up to cut_coul, with one lambda, for a long-range solver; one cutoff given means
both. Force of coul/long/soft: see there."""
from __future__ import annotations

from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.pair.lj_cut_coul_cut_soft import derived
from asemd.pair.lj_cut_soft import SoftPair, lj_cut_soft, tail
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="n alphaLJ alphaC cut_lj [cut_coul]", coeff="epsilon sigma lambda [cut_lj]", derived=derived,
               rows="front core weight gap", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
               units={"epsilon": "energy", "alphaC": "distance^2"}, settings_example="2.0 0.5 5.0 8.0 10.0", example="0.1 3.0 0.7 7.0",
               splits=True, see="LAMMPS manual, pair_style lj/cut/coul/long/soft")
style = pair_sum("lj/cut/coul/long/soft", (lj_cut_soft, "cut_lj"), (coul_long_soft, "cut_coul"), cls=SoftPair, **OPTIONS)
style.twin = SoftPair("lj/cut/coul/long/soft", [(lj_cut_soft, "cut_lj"), (coul_long_soft_lammps, "cut_coul")], doc=__doc__, **OPTIONS)
