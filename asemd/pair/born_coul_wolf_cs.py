r"""The sum of born up to cut_born and coul/wolf/cs up to cut_coul, for cores and shells; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.born import born
from asemd.pair.born_coul_wolf import OPTIONS as WOLF
from asemd.pair.coul_wolf import DampedSum
from asemd.pair.coul_wolf_cs import coul_wolf_cs, coul_wolf_cs_lammps
from asemd.pairstyle import pair_sum

OPTIONS = WOLF | dict(see="LAMMPS manual, pair_style born/coul/wolf/cs")
style = pair_sum("born/coul/wolf/cs", (born, "cut_born"), (coul_wolf_cs, "cut_coul"), cls=DampedSum, **OPTIONS)
style.twin = DampedSum("born/coul/wolf/cs", [(born, "cut_born"), (coul_wolf_cs_lammps, "cut_coul")], doc=__doc__, **OPTIONS)
