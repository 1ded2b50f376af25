r"""The sum of buck up to cut_buck and coul/long/cs up to cut_coul, for cores and shells and a long-range solver; one cutoff given means
both."""
from __future__ import annotations

from asemd.pair.buck import buck
from asemd.pair.buck_coul_long import OPTIONS
from asemd.pair.coul_long_cs import coul_long_cs
from asemd.pairstyle import pair_sum

pair_sum("buck/coul/long/cs", (buck, "cut_buck"), (coul_long_cs, "cut_coul"), see="LAMMPS manual, pair_style buck/coul/long/cs", **OPTIONS)
