r"""$$E = U(\theta - \theta_0) - U(0)$$

Any formula U of the bend, given as an expression in ``theta`` (which stands for $\theta - \theta_0$ in radians), with its derivative as
the force.
Operators ``+ - * / ^``; functions sqrt exp log sin cos sec csc tan cot asin acos atan atan2 sinh cosh tanh erf erfc
min max abs step delta select square cube recip floor ceil; ``; name=value`` after the expression defines a name in it, ``v_name`` is a
variable of the script. An expression with blanks or semicolons stands in quotation marks.
Source: LAMMPS manual, angle_style lepton.
"""
from __future__ import annotations

from asemd.expression_style import ExpressionStyle
from asemd.style import register

register(ExpressionStyle("angle", "lepton", "theta", "theta0", example="110.1 k*theta^2+h*theta^3;k=75.0;h=-20.0",
                         settings_example="no_offset", doc=__doc__))
