r"""Several pair styles at once, each serving its own pairs of types.

``pair_style hybrid lj/cut 10.0 morse 6.0`` lists the sub-styles, ``pair_coeff 1 2 morse 1.0 2.0 1.5`` gives a pair of types to one of
them. Each sub-style is a `asemd.forcefield.Use` of `asemd.forcefield.Interactions`, which assigns and mixes.
"""
from __future__ import annotations

from asemd.pairstyle import PairStyle
from asemd.style import register

register(PairStyle("hybrid", [], doc=__doc__, see="LAMMPS manual, pair_style hybrid"))
