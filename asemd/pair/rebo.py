r"""Reactive bond-order potential of hydrocarbons of the second generation (REBO): the bonds of `pair airebo` alone."""
from __future__ import annotations

from asemd import words as read
from asemd.kernels import bond_order as kernels
from asemd.pair.airebo import AIREBO, OPTIONS
from asemd.style import register


class REBO(AIREBO):
    usual, title, lone = "", "REBO2", "rebo"

    def parse_settings(self, words):
        read.exactly(words, 0, f"pair_style {self.name}")
        return {"cutoff": 0.0, "LJ_flag": 0, "TORSION_flag": 0}

    def format_settings(self, settings):
        return []


register(REBO("rebo", helpers=kernels.HELPERS, example="CH.rebo C", doc=__doc__,
              see="D. W. Brenner et al., J. Phys.: Condens. Matter 14, 783 (2002)", **OPTIONS))
