r"""$$E = 0$$

No bond interaction at all: no forces, and no coefficients. Source: LAMMPS manual, bond_style none.
"""
from __future__ import annotations

from asemd.style import Style, register

none = register(Style("bond", "none", None, doc=__doc__))
