r"""lj/long/coul/long for charges of which each stands in a medium of its own, as in coul/cut/dielectric.

Its solver is pppm/disp/dielectric; with ``cut long`` pppm/dielectric, and with ``long off`` any one of dispersion.
"""
from __future__ import annotations

import inspect

from asemd.dielectric_pairs import DielectricPair
from asemd.pair.lj_cut import lj_cut
from asemd.pair.lj_long_coul_long import DispersionPair, derived, dispersion, repulsion
from asemd.style import register


class DielectricDispersionPair(DispersionPair, DielectricPair):
    def form(self, coulomb):
        return DielectricPair

    def needs(self, settings):
        if settings["coulomb"] == "off":
            return super().needs(settings) | ({"pppm/disp/dielectric"} if settings["dispersion"] == "long" else set())
        return frozenset(["pppm/dielectric" if settings["dispersion"] == "cut" else "pppm/disp/dielectric"])


register(DielectricDispersionPair(
    "lj/long/coul/long/dielectric", [lj_cut], [repulsion, dispersion], "cut_lj", coeff="epsilon sigma [cut_lj]", rows="C6", derived=derived,
    mix={"epsilon": "sigma", "sigma": "distance"}, settings_example="long long 10.0", example="0.1 3.0", doc=inspect.cleandoc(__doc__)))
