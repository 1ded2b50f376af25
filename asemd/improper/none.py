r"""$$E = 0$$

No improper interaction at all: no forces, and no coefficients. Source: LAMMPS manual, improper_style none.
"""
from __future__ import annotations

from asemd.style import Style, register

none = register(Style("improper", "none", None, doc=__doc__))
