r"""The sum of born up to cut_born and coul/long up to cut_coul, for a long-range solver; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.born import born, check, tail
from asemd.pair.coul_long import coul_long
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="cut_born [cut_coul]", coeff="a rho sigma c d [cut_born]", defaults={"cut_coul": "cut_born"}, check=check,
               tail=tail, settings_example="8.0 10.0", example="6.08 0.317 2.34 24.18 11.51 7.0")
pair_sum("born/coul/long", (born, "cut_born"), (coul_long, "cut_coul"), see="LAMMPS manual, pair_style born/coul/long", **OPTIONS)
