r"""The sum of lj/cut up to cut_lj and coul/wolf up to cut_coul; one cutoff given means both. Force of coul/wolf: see there."""
from __future__ import annotations

from asemd.pair.coul_wolf import DampedSum, coul_wolf, coul_wolf_lammps
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="alpha cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]", defaults={"cut_coul": "cut_lj"},
               mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, settings_example="0.2 8.0 10.0", example="0.1 3.0 7.0",
               see="LAMMPS manual, pair_style lj/cut/coul/wolf")
style = pair_sum("lj/cut/coul/wolf", (lj_cut, "cut_lj"), (coul_wolf, "cut_coul"), cls=DampedSum, **OPTIONS)
style.twin = DampedSum("lj/cut/coul/wolf", [(lj_cut, "cut_lj"), (coul_wolf_lammps, "cut_coul")], doc=__doc__, **OPTIONS)
