r"""The sum of lj/cut/soft between atoms up to cut_lj and tip4p/long/soft up to cut_coul, with one lambda: four-site water (TIP4P) with
kspace_style pppm/tip4p; one cutoff given means both.

Hydrogen atoms of water have no Lennard-Jones interactions. Source: LAMMPS manual, pair_style lj/cut/tip4p/long/soft.
"""
from __future__ import annotations

from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.pair.lj_cut_coul_cut_soft import derived
from asemd.pair.lj_cut_soft import lj_cut_soft, tail
from asemd.tip4p import TIP4PSoft, tip4p

OPTIONS = dict(settings="n alphaLJ alphaC cut_lj [cut_coul]", coeff="epsilon sigma lambda [cut_lj]", derived=derived,
               rows="front core weight gap", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
               units={"epsilon": "energy", "alphaC": "distance^2"}, settings_example="1 2 1 1 0.15 2.0 0.5 5.0 8.0 10.0",
               example="0.1 3.0 0.7 7.0", see="LAMMPS manual, pair_style lj/cut/tip4p/long/soft")
style = tip4p("lj/cut/tip4p/long/soft", (lj_cut_soft, "cut_lj"), (coul_long_soft, "cut_coul"), cls=TIP4PSoft, **OPTIONS)
style.twin = TIP4PSoft("lj/cut/tip4p/long/soft", [(lj_cut_soft, "cut_lj"), (coul_long_soft_lammps, "cut_coul")], doc=__doc__, **OPTIONS)
