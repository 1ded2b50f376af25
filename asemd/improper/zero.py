r"""$$E = 0$$

Impropers without forces: their geometry can be measured. Source: LAMMPS manual, improper_style zero.
"""
from __future__ import annotations

from asemd.style import ZeroStyle, register

zero = register(ZeroStyle("improper", doc=__doc__))
