r"""$$E = 0$$

No dihedral interaction at all: no forces, and no coefficients. Source: LAMMPS manual, dihedral_style none.
"""
from __future__ import annotations

from asemd.style import Style, register

none = register(Style("dihedral", "none", None, doc=__doc__))
