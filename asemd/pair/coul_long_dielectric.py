r"""coul/cut/dielectric without a cutoff: within one the part that kspace_style pppm/dielectric leaves, as in coul/long."""
from __future__ import annotations

from asemd.dielectric_pairs import DielectricPair
from asemd.pair.coul_long import coul_long
from asemd.pairstyle import pair_sum

pair_sum("coul/long/dielectric", (coul_long, "cut"), cls=DielectricPair, scales=True, settings="cut", coeff="", settings_example="10.0",
         example="", units={"g_ewald": "1/distance"})
