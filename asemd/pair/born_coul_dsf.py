r"""The sum of born up to cut_born and coul/dsf up to cut_coul, here with the exact complementary error function; one cutoff given means
both."""
from __future__ import annotations

from asemd.pair.born import born, check
from asemd.pair.coul_dsf import ForceShiftedSum, coul_dsf_exact
from asemd.pairstyle import pair_sum

OPTIONS = dict(settings="alpha cut_born [cut_coul]", coeff="a rho sigma c d [cut_born]", defaults={"cut_coul": "cut_born"}, check=check,
               settings_example="0.2 8.0 10.0", example="6.08 0.317 2.34 24.18 11.51 7.0")
pair_sum("born/coul/dsf", (born, "cut_born"), (coul_dsf_exact, "cut_coul"), cls=ForceShiftedSum, **OPTIONS,
         see="LAMMPS manual, pair_style born/coul/dsf")
