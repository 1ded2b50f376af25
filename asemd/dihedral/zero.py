r"""$$E = 0$$

Dihedrals without forces: their geometry can be measured. Source: LAMMPS manual, dihedral_style zero.
"""
from __future__ import annotations

from asemd.style import ZeroStyle, register

zero = register(ZeroStyle("dihedral", doc=__doc__))
