r"""$$E = \sum_s E_s$$

Several bond styles side by side: each bond type belongs to one of the styles named after ``bond_style hybrid``, and its
coefficients begin with that style's name. Source: LAMMPS manual, bond_style hybrid.
"""
from __future__ import annotations

from asemd.style import Style, register

hybrid = register(Style("bond", "hybrid", None, doc=__doc__))
