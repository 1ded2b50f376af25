r"""Gao-Weber potential that goes over into the screened repulsion of nuclei at short distances: the bond order of `pair gw`, the rest as in
`pair tersoff/zbl`."""
from __future__ import annotations

from asemd.pair.gw import order, order8
from asemd.pair.tersoff import OPTIONS, angular, longer, taper, tersoff
from asemd.pair.tersoff_eight import angular8, taper8
from asemd.pair.tersoff_zbl import TersoffZBL, attraction, fermi, pair8, repulsion
from asemd.style import register


class GaoWeberZBL(TersoffZBL):
    def parse_settings(self, words):
        self._read(words, (), "pair_style")
        return {"shift": 0.0}


register(GaoWeberZBL("gw/zbl", site=tersoff, helpers=(taper, fermi, repulsion, attraction, angular, order, longer), doc=__doc__,
                     example="SiC.gw.zbl Si", rooms=OPTIONS["rooms"], eight=OPTIONS["eight"], eight_rows=OPTIONS["eight_rows"],
                     eight_helpers=(taper8, angular8, order8, pair8), see="LAMMPS manual, pair_style gw/zbl"))
