r"""The sum of born up to cut_born and coul/dsf up to cut_coul, for cores and shells, whose special pairs may stand in one place (see
coul/wolf/cs); one cutoff given means both."""
from __future__ import annotations

import math

from asemd.pair.born import born
from asemd.pair.born_coul_dsf import OPTIONS
from asemd.pair.coul_dsf import ForceShiftedSum, coul_dsf_d2, coul_dsf_exact
from asemd.pair.coul_wolf_cs import copied
from asemd.pairstyle import pair_sum


def special(r2, qq, alpha, bell, start, end, off):
    s = r2 + 1e-20
    r = math.sqrt(s)
    x = alpha * r
    gauss = math.exp(-x * x)
    outside, inside = math.erfc(x) / r, math.erf(x) / r
    rest = inside - bell * gauss
    if x < 0.5:      # as in coul/wolf/cs
        term = bell * gauss
        rest = 0.0
        for n in range(1, 16):
            term *= 2.0 * x * x / (2.0 * n + 1.0)
            rest += term
    return (qq * ((1.0 - off) * outside - off * inside - start - r * end),
            -0.5 * qq * (((1.0 - off) * (outside + bell * gauss) - off * rest) / s + end / r))


coul_dsf_cs = copied(coul_dsf_exact, "coul_dsf_cs")
coul_dsf_cs.special, coul_dsf_cs.d2 = special, coul_dsf_d2
pair_sum("born/coul/dsf/cs", (born, "cut_born"), (coul_dsf_cs, "cut_coul"), cls=ForceShiftedSum, **OPTIONS,
         see="LAMMPS manual, pair_style born/coul/dsf/cs")
