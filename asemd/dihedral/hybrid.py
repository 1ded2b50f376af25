r"""$$E = \sum_s E_s$$

Several dihedral styles side by side: each dihedral type belongs to one of the styles named after ``dihedral_style hybrid``, and its
coefficients begin with that style's name. Source: LAMMPS manual, dihedral_style hybrid.
"""
from __future__ import annotations

from asemd.style import Style, register

hybrid = register(Style("dihedral", "hybrid", None, doc=__doc__))
