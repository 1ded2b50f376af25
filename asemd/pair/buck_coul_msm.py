r"""The sum of buck up to cut_buck and coul/msm up to cut_coul, for multilevel summation; one cutoff given means both.

LAMMPS computes it without tables, whatever pair_modify says.
"""
from __future__ import annotations

from asemd.pair.buck import buck
from asemd.pair.buck_coul_long import OPTIONS
from asemd.pair.coul_msm import coul_msm
from asemd.pairstyle import pair_sum

style = pair_sum("buck/coul/msm", (buck, "cut_buck"), (coul_msm, "cut_coul"), see="LAMMPS manual, pair_style buck/coul/msm", **OPTIONS)
style.takes_tables = False
