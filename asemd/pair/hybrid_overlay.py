r"""Several pair styles at once, added up: a pair of types may be served by more than one of them (see `asemd.pair.hybrid`)."""
from __future__ import annotations

from asemd.pairstyle import PairStyle
from asemd.style import register

register(PairStyle("hybrid/overlay", [], doc=__doc__, see="LAMMPS manual, pair_style hybrid/overlay"))
