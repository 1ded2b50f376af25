r"""The sum of buck up to cut_buck and coul/cut up to cut_coul; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.buck import buck, check, tail
from asemd.pair.coul_cut import coul_cut
from asemd.pairstyle import pair_sum

pair_sum("buck/coul/cut", (buck, "cut_buck"), (coul_cut, "cut_coul"), settings="cut_buck [cut_coul]",
         coeff="A rho C [cut_buck] [cut_coul]", defaults={"cut_coul": "cut_buck"}, tail=tail, check=check,
         units={"C": "energy*distance^6"}, settings_example="8.0 10.0", example="100.0 0.3 20.0 7.0 9.0",
         see="LAMMPS manual, pair_style buck/coul/cut")
