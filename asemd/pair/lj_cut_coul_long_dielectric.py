r"""The sum of lj/cut up to cut_lj and coul/long/dielectric up to cut_coul, for kspace_style pppm/dielectric; one cutoff means both."""
from __future__ import annotations

from asemd.dielectric_pairs import DielectricPair
from asemd.pair.coul_long import coul_long
from asemd.pair.lj_cut import lj_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("lj/cut/coul/long/dielectric", (lj_cut, "cut_lj"), (coul_long, "cut_coul"), cls=DielectricPair,
         settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj]", defaults={"cut_coul": "cut_lj"},
         mix={"epsilon": "sigma", "sigma": "distance"}, tail=tail, settings_example="8.0 10.0", example="0.1 3.0 7.0")
