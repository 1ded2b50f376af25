r"""$$E = 0$$

Bonds without forces: their geometry can be measured, and r0 is the length that constraints use.
Source: LAMMPS manual, bond_style zero.
"""
from __future__ import annotations

from asemd.style import Parameter, ZeroStyle, register

zero = register(ZeroStyle("bond", (Parameter("r0", "distance", optional=True),), doc=__doc__, equilibrium="r0"))
