r"""Gao-Weber potential of silicon carbide: Tersoff's form with the bond order $b_{ij}=(1+\beta\zeta_{ij})^{-n}$.

The rest, the numbers of the file included, is as in `pair tersoff`.
"""
from __future__ import annotations

import math

from asemd.kernels.functions8 import exp8, log8
from asemd.pair.tersoff import OPTIONS, Tersoff, angular, attraction, longer, repulsion, taper, tersoff
from asemd.pair.tersoff_eight import angular8, pair8, taper8
from asemd.style import register


def order(zeta, p):
    """Bond order and its derivative by zeta."""
    t = 1.0 + p[15] * zeta
    b = math.pow(t, -p[14])
    return b, -p[14] * p[15] * b / t


def order8(zeta, n, beta, table, types, at):
    """The same of eight bonds."""
    t = beta * zeta + 1.0
    b = exp8(-1.0 * n * log8(t))
    return b, -1.0 * n * beta * b / t


class GaoWeber(Tersoff):
    def parse_settings(self, words):
        self._read(words, (), "pair_style")
        return {"shift": 0.0}


register(GaoWeber("gw", site=tersoff, helpers=(taper, repulsion, attraction, angular, order, longer), example="SiC.gw Si",
                  doc=__doc__, rooms=OPTIONS["rooms"], eight=OPTIONS["eight"], eight_rows=OPTIONS["eight_rows"],
                  eight_helpers=(taper8, angular8, order8, pair8), see="F. Gao and W. J. Weber, Nucl. Instr. Meth. B 191, 504 (2002)"))
