r"""The sum of nm/cut up to cut_nm and coul/long up to cut_coul, for a long-range solver; one cutoff given means both."""
from __future__ import annotations

from asemd.pair.coul_long import coul_long
from asemd.pair.nm_cut import check, derived, nm_cut, tail
from asemd.pairstyle import pair_sum

pair_sum("nm/cut/coul/long", (nm_cut, "cut_nm"), (coul_long, "cut_coul"), settings="cut_nm [cut_coul]", derived=derived, rows="front",
         coeff="e0 r0 nn mm [cut_nm]", defaults={"cut_coul": "cut_nm"}, tail=tail, check=check, units={"e0": "energy"},
         settings_example="8.0 10.0", example="0.1 3.0 8.0 6.0 7.0", see="LAMMPS manual, pair_style nm/cut/coul/long")
