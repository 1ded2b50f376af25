r"""The sum of born up to cut_born and coul/msm up to cut_coul, for multilevel summation; one cutoff given means both.

LAMMPS computes it without tables, whatever pair_modify says.
"""
from __future__ import annotations

from asemd.pair.born import born
from asemd.pair.born_coul_long import OPTIONS
from asemd.pair.coul_msm import coul_msm
from asemd.pairstyle import pair_sum

style = pair_sum("born/coul/msm", (born, "cut_born"), (coul_msm, "cut_coul"), see="LAMMPS manual, pair_style born/coul/msm", **OPTIONS)
style.takes_tables = False
