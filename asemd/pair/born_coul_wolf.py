r"""The sum of born up to cut_born and coul/wolf up to cut_coul; one cutoff given means both. Force of coul/wolf: see there."""
from __future__ import annotations

from asemd.pair.born import born, check
from asemd.pair.coul_wolf import DampedSum, coul_wolf, coul_wolf_lammps
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="alpha cut_born [cut_coul]", coeff="a rho sigma c d [cut_born]", defaults={"cut_coul": "cut_born"}, check=check,
               settings_example="0.2 8.0 10.0", example="6.08 0.317 2.34 24.18 11.51 7.0",
               see="LAMMPS manual, pair_style born/coul/wolf")
style = pair_sum("born/coul/wolf", (born, "cut_born"), (coul_wolf, "cut_coul"), cls=DampedSum, **OPTIONS)
style.twin = DampedSum("born/coul/wolf", [(born, "cut_born"), (coul_wolf_lammps, "cut_coul")], doc=__doc__, **OPTIONS)
