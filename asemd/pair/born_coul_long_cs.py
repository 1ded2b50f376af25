r"""The sum of born up to cut_born and coul/long/cs up to cut_coul, for cores and shells and a long-range solver; one cutoff given means
both."""
from __future__ import annotations

from asemd.pair.born import born
from asemd.pair.born_coul_long import OPTIONS
from asemd.pair.coul_long_cs import coul_long_cs
from asemd.pairstyle import pair_sum

pair_sum("born/coul/long/cs", (born, "cut_born"), (coul_long_cs, "cut_coul"), see="LAMMPS manual, pair_style born/coul/long/cs", **OPTIONS)
