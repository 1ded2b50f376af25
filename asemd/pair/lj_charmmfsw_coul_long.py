r"""Lennard-Jones whose force is switched off between inner and outer, as in lj/charmmfsw/coul/charmmfsh, and coul/long up to cut_coul, for
a long-range solver.

epsilon14 and sigma14 (default: epsilon, sigma) are used for the ends of a dihedral, see lj/charmmfsw/coul/charmmfsh; there it is also said
where LAMMPS's force differs from the gradient of its energy. Steinbach and Brooks, J. Comput. Chem. 15, 667 (1994).
"""
from __future__ import annotations

from asemd.pair.coul_cut import coul_cut
from asemd.pair.coul_long import coul_long
from asemd.pair.lj_charmmfsw_coul_charmmfsh import OPTIONS as CHARMM
from asemd.pair.lj_charmmfsw_coul_charmmfsh import CharmmSwitchedPair, lj_charmmfsw, lj_charmmfsw_lammps, lj_shifted
from asemd.pairstyle import make_part, pair_sum


class CharmmSwitchedLongPair(CharmmSwitchedPair):
    """The Coulomb interaction of the ends of a dihedral is not shifted."""

    one_four_shifted_parts = (make_part(lj_shifted, "", ("epsilon", "sigma")), make_part(coul_cut, "", ()))


OPTIONS = CHARMM | dict(splits=True, see="LAMMPS manual, pair_style lj/charmmfsw/coul/long")
style = pair_sum("lj/charmmfsw/coul/long", (lj_charmmfsw, "outer"), (coul_long, "cut_coul"), cls=CharmmSwitchedLongPair, **OPTIONS)
style.twin = CharmmSwitchedLongPair("lj/charmmfsw/coul/long", [(lj_charmmfsw_lammps, "outer"), (coul_long, "cut_coul")], doc=__doc__,
                                    **OPTIONS)
