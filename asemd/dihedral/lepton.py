r"""$$E = U(\phi)$$

Any formula U of the torsion angle, given as an expression in ``phi`` (radians, $\pi$ is trans), with its derivative as the force. An
expression that is not periodic, such as ``phi^2``, sees angles from 0 to $2\pi$ as in LAMMPS; a periodic one is evaluated between $-\pi$
and $\pi$, where small angles keep their digits.
Operators ``+ - * / ^``; functions sqrt exp log sin cos sec csc tan cot asin acos atan atan2 sinh cosh tanh erf erfc
min max abs step delta select square cube recip floor ceil; ``; name=value`` after the expression defines a name in it, ``v_name`` is a
variable of the script. An expression with blanks or semicolons stands in quotation marks.
Source: LAMMPS manual, dihedral_style lepton.
"""
from __future__ import annotations

from asemd.expression_style import ExpressionStyle
from asemd.style import register

register(ExpressionStyle("dihedral", "lepton", "phi", "", example="k*(1+d*cos(n*phi))+h*sin(phi);k=4.5;d=-1;n=3;h=0.3", doc=__doc__))
