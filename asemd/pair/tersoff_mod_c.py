r"""Tersoff potential of Kumagai with a constant in the repulsion: $f_R=Ae^{-\lambda_1r}+c_0$; see `pair tersoff/mod`."""
from __future__ import annotations

import math

from asemd.pair.tersoff import OPTIONS, attraction, longer, tersoff
from asemd.pair.tersoff_mod import TersoffMod, angular, order, taper
from asemd.style import register


def repulsion(r, p):
    fc, slope = taper(r, p)
    e = p[4] * math.exp(-p[5] * r)
    return fc * (e + p[21]), slope * (e + p[21]) - fc * p[5] * e


class TersoffModC(TersoffMod):
    names = f"{TersoffMod.names} c0"
    columns = (*TersoffMod.columns, "c0")
    energies = ("A", "B", "c0")


register(TersoffModC("tersoff/mod/c", site=tersoff, helpers=(taper, repulsion, attraction, angular, order, longer),
                     example="Si.tersoff.modc Si", doc=__doc__,
                     see="G. P. Purja Pun and Y. Mishin, Phys. Rev. B 95, 224103 (2017)", **OPTIONS))
