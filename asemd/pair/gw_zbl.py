r"""Gao-Weber potential that goes over into the screened repulsion of nuclei at short distances: the bond order of `pair gw`, the rest as in
`pair tersoff/zbl`."""
from __future__ import annotations

from asemd.pair.gw import order
from asemd.pair.tersoff import OPTIONS, angular, longer, taper, tersoff
from asemd.pair.tersoff_zbl import TersoffZBL, attraction, fermi, repulsion
from asemd.style import register


class GaoWeberZBL(TersoffZBL):
    def parse_settings(self, words):
        self._read(words, (), "pair_style")
        return {"shift": 0.0}


register(GaoWeberZBL("gw/zbl", site=tersoff, helpers=(taper, fermi, repulsion, attraction, angular, order, longer), doc=__doc__,
                     example="SiC.gw.zbl Si", rooms=OPTIONS["rooms"], see="LAMMPS manual, pair_style gw/zbl"))
