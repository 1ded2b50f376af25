r"""$$E = U(r - r_0) - U(0)$$

Any formula U of the stretch, given as an expression in ``r`` (which stands for $r - r_0$), with its derivative as the force.
Source: LAMMPS manual, bond_style lepton.
"""
from __future__ import annotations

from asemd.expression_style import ExpressionStyle
from asemd.style import register

register(ExpressionStyle("bond", "lepton", "r", "r0", example="1.1 k2*r^2+k3*r^3+k4*r^4;k2=300.0;k3=-100.0;k4=50.0",
                         settings_example="no_offset", doc=__doc__))
