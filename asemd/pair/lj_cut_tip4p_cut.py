r"""The sum of lj/cut between atoms up to cut_lj and tip4p/cut up to cut_coul: four-site water (TIP4P); one cutoff given means both.

Hydrogen atoms of water have no Lennard-Jones interactions. Source: LAMMPS manual, pair_style lj/cut/tip4p/cut.
"""
from __future__ import annotations

from asemd.pair.coul_cut import coul_cut
from asemd.pair.lj_cut import lj_cut, tail
from asemd.tip4p import tip4p

tip4p("lj/cut/tip4p/cut", (lj_cut, "cut_lj"), (coul_cut, "cut_coul"), settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]",
      defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail,
      settings_example="1 2 1 1 0.15 8.0 10.0", example="0.1 3.0 7.0", see="LAMMPS manual, pair_style lj/cut/tip4p/cut")
