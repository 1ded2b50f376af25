r"""$$E = 0$$

No angle interaction at all: no forces, and no coefficients. Source: LAMMPS manual, angle_style none.
"""
from __future__ import annotations

from asemd.style import Style, register

none = register(Style("angle", "none", None, doc=__doc__))
