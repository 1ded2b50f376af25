r"""Tersoff potential of Kumagai with a constant in the repulsion: $f_R=Ae^{-\lambda_1r}+c_0$; see `pair tersoff/mod`."""
from __future__ import annotations

import math

from asemd.kernels.eight_sites import coefficients8
from asemd.kernels.functions8 import exp8
from asemd.pair.tersoff import OPTIONS, attraction, longer, tersoff
from asemd.pair.tersoff_mod import TersoffMod, angular, angular8, order, order8, taper, taper8
from asemd.style import register


def repulsion(r, p):
    fc, slope = taper(r, p)
    e = p[4] * math.exp(-p[5] * r)
    return fc * (e + p[21]), slope * (e + p[21]) - fc * p[5] * e


def pair8(r, fc, dfc, table, types, at):
    """Repulsion and attraction of eight pairs, with their derivatives."""
    ca, l1, cb, l2 = coefficients8(table, types, at, 4)
    _, c0, _, _ = coefficients8(table, types, at, 20)
    fr, fa = ca * exp8(-1.0 * l1 * r), -1.0 * cb * exp8(-1.0 * l2 * r)
    return fc * (fr + c0), dfc * (fr + c0) - fc * l1 * fr, fa * fc, fa * (dfc - l2 * fc)


class TersoffModC(TersoffMod):
    names = f"{TersoffMod.names} c0"
    columns = (*TersoffMod.columns, "c0")
    energies = ("A", "B", "c0")


register(TersoffModC("tersoff/mod/c", site=tersoff, helpers=(taper, repulsion, attraction, angular, order, longer),
                     example="Si.tersoff.modc Si", doc=__doc__, eight_helpers=(taper8, angular8, order8, pair8),
                     see="G. P. Purja Pun and Y. Mishin, Phys. Rev. B 95, 224103 (2017)", **OPTIONS))
