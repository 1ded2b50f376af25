r"""The sum of buck up to cut_buck and coul/long up to cut_coul, for a long-range solver; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.buck import buck, check, tail
from asemd.pair.coul_long import coul_long
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="cut_buck [cut_coul]", coeff="A rho C [cut_buck]", defaults={"cut_coul": "cut_buck"}, tail=tail, check=check,
               units={"C": "energy*distance^6"}, settings_example="8.0 10.0", example="100.0 0.3 20.0 7.0")
pair_sum("buck/coul/long", (buck, "cut_buck"), (coul_long, "cut_coul"), see="LAMMPS manual, pair_style buck/coul/long", **OPTIONS)
