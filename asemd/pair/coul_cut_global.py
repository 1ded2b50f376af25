r"""E = C q_i q_j / (dielectric r) for r < cut, with one cutoff for all pairs of types: pair_coeff has no values."""
from __future__ import annotations

from asemd.pair.coul_cut import coul_cut
from asemd.pairstyle import pair_sum

pair_sum("coul/cut/global", (coul_cut, "cut"), scales=True, settings="cut", mix={"cut": "distance"}, settings_example="10.0",
         see="LAMMPS manual, pair_style coul/cut/global")
