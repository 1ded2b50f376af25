r"""coul/wolf for cores and shells of polarisable atoms: special pairs may stand in one place.

Their energy is written with the error function, so that it stays finite and keeps its digits where a core and its shell meet; LAMMPS adds
1e-20 to the squared distance, as is done here. Force of coul/wolf: see there.
Mitchell and Fincham, J. Phys. Condens. Matter 5, 1031 (1993).
"""
from __future__ import annotations

import math

from asemd.pair.coul_wolf import OPTIONS as WOLF
from asemd.pair.coul_wolf import DampedPair, bare_special, coul_wolf, coul_wolf_d2, coul_wolf_lammps
from asemd.pairstyle import pair_sum


def special(r2, qq, alpha, bell, last, off):
    s = r2 + 1e-20
    r = math.sqrt(s)
    x = alpha * r
    gauss = math.exp(-x * x)
    outside, inside = math.erfc(x) / r, math.erf(x) / r
    rest = inside - bell * gauss
    if x < 0.5:      # by the sum over n > 0 of (2 x^2)^n / (2n+1)!!
        term = bell * gauss
        rest = 0.0
        for n in range(1, 16):
            term *= 2.0 * x * x / (2.0 * n + 1.0)
            rest += term
    return (qq * ((1.0 - off) * outside - off * inside - last),
            -0.5 * qq * ((1.0 - off) * (outside + bell * gauss) - off * rest) / s)


def special_lammps(r2, qq, alpha, bell, last, end, off):
    s = r2 + 1e-20
    r = math.sqrt(s)
    x = alpha * r
    gauss = math.exp(-x * x)
    outside, inside = math.erfc(x) / r, math.erf(x) / r
    rest = inside - bell * gauss
    if x < 0.5:
        term = bell * gauss
        rest = 0.0
        for n in range(1, 16):
            term *= 2.0 * x * x / (2.0 * n + 1.0)
            rest += term
    return (qq * ((1.0 - off) * outside - off * inside - last),
            -0.5 * qq * (((1.0 - off) * (outside + bell * gauss) - off * rest) / s + end / r))


def copied(function, name: str):
    """The same function under another name, to be given special pairs of its own."""
    twin = bare_special(type(function)(function.__code__, function.__globals__, name))
    twin.__annotations__, twin.__module__ = function.__annotations__, function.__module__
    return twin


coul_wolf_cs, coul_wolf_cs_lammps = copied(coul_wolf, "coul_wolf_cs"), copied(coul_wolf_lammps, "coul_wolf_cs_lammps")
coul_wolf_cs.special, coul_wolf_cs_lammps.special, coul_wolf_cs.d2 = special, special_lammps, coul_wolf_d2
OPTIONS = WOLF | dict(see="LAMMPS manual, pair_style coul/wolf/cs")
style = pair_sum("coul/wolf/cs", (coul_wolf_cs, "cut"), cls=DampedPair, **OPTIONS)
style.twin = DampedPair("coul/wolf/cs", [(coul_wolf_cs_lammps, "cut")], doc=__doc__, **OPTIONS)
