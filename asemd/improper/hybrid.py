r"""$$E = \sum_s E_s$$

Several improper styles side by side: each improper type belongs to one of the styles named after ``improper_style hybrid``, and its
coefficients begin with that style's name. Source: LAMMPS manual, improper_style hybrid.
"""
from __future__ import annotations

from asemd.style import Style, register

hybrid = register(Style("improper", "hybrid", None, doc=__doc__))
