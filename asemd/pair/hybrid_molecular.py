r"""Two pair styles: the first for pairs of atoms of one molecule, the second for pairs of different molecules (see `asemd.pair.hybrid`)."""
from __future__ import annotations

from asemd.pairstyle import PairStyle
from asemd.style import register

register(PairStyle("hybrid/molecular", [], doc=__doc__, see="LAMMPS manual, pair_style hybrid/molecular"))
