r"""Several pair styles at once, added up with factors: numbers, or variables whose values may change during a run.

``pair_style hybrid/scaled 0.3 lj/cut 10.0 v_rest morse 6.0``: energies, forces and stresses of each sub-style are multiplied by its factor
(see `asemd.pair.hybrid`). An equal-style variable is evaluated at each step. An atom-style variable multiplies the force on each atom by
the atom's value; such a sub-style has no energy.
"""
from __future__ import annotations

from asemd.pairstyle import PairStyle
from asemd.style import register

register(PairStyle("hybrid/scaled", [], doc=__doc__, see="LAMMPS manual, pair_style hybrid/scaled"))
