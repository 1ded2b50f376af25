r"""$$E = 0$$

Angles without forces: their geometry can be measured, and theta0 is the angle that constraints use.
Source: LAMMPS manual, angle_style zero.
"""
from __future__ import annotations

from asemd.style import Parameter, ZeroStyle, register

zero = register(ZeroStyle("angle", (Parameter("theta0", "angle", optional=True),), doc=__doc__, equilibrium="theta0"))
