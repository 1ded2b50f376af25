r"""$$E = \sum_s E_s$$

Several angle styles side by side: each angle type belongs to one of the styles named after ``angle_style hybrid``, and its
coefficients begin with that style's name. Source: LAMMPS manual, angle_style hybrid.
"""
from __future__ import annotations

from asemd.style import Style, register

hybrid = register(Style("angle", "hybrid", None, doc=__doc__))
