r"""The part of q_i q_j / r within the cutoff that kspace_style pppm/tip4p leaves, for charges of four-site water (TIP4P), see tip4p/cut:
the charge of an oxygen atom is on a massless site. Source: LAMMPS manual, pair_style tip4p/long.
"""
from __future__ import annotations

from asemd.pair.coul_long import coul_long
from asemd.tip4p import tip4p

tip4p("tip4p/long", (coul_long, "cut"), settings="cut", coeff="", settings_example="1 2 1 1 0.15 10.0", example="",
      see="LAMMPS manual, pair_style tip4p/long")
