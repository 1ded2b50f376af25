r"""No pair interactions at all, and no neighbour list for them.  `asemd.forcefield.Interactions` holds no pair term then."""
from __future__ import annotations

from asemd.pairstyle import PairStyle
from asemd.style import register

register(PairStyle("none", [], doc=__doc__, see="LAMMPS manual, pair_style none"))
