r"""$$E = U(r - r_0) - U(0)$$

Any formula U of the stretch, given as an expression in ``r`` (which stands for $r - r_0$), with its derivative as the force.
Operators ``+ - * / ^``; functions sqrt exp log sin cos sec csc tan cot asin acos atan atan2 sinh cosh tanh erf erfc
min max abs step delta select square cube recip floor ceil; ``; name=value`` after the expression defines a name in it, ``v_name`` is a
variable of the script. An expression with blanks or semicolons stands in quotation marks.
Source: LAMMPS manual, bond_style lepton.
"""
from __future__ import annotations

from asemd.expression_style import ExpressionStyle
from asemd.style import register

register(ExpressionStyle("bond", "lepton", "r", "r0", example="1.1 k2*r^2+k3*r^3+k4*r^4;k2=300.0;k3=-100.0;k4=50.0",
                         settings_example="no_offset", doc=__doc__))
