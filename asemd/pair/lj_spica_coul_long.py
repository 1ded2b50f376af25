r"""The sum of lj/spica up to cut_lj and coul/long up to cut_coul, for a long-range solver; one cutoff given means both."""
from __future__ import annotations

import inspect
import sys

from asemd.pair.coul_long import coul_long
from asemd.pair.lj_spica import SpicaPair, lj_spica
from asemd.pairstyle import PairStyle
from asemd.style import register


class SpicaLongPair(SpicaPair):
    """Words of lj/spica with a second cutoff."""

    def __init__(self, name: str, coulomb=coul_long, doc: str = inspect.getdoc(sys.modules[__name__])):
        PairStyle.__init__(self, name, [(lj_spica, "cut_lj"), (coulomb, "cut_coul")], settings="cut_lj [cut_coul]",
                           coeff="lj_type epsilon sigma [cut_lj]", rows="front n m", defaults={"cut_coul": "cut_lj"},
                           units={"lj_type": "word", "epsilon": "energy"}, settings_example="8.0 10.0", example="lj9_6 0.1 3.0 7.5",
                           see=f"LAMMPS manual, pair_style {name}", doc=doc)


style = register(SpicaLongPair("lj/spica/coul/long"))
