r"""Concentration-dependent embedded-atom potential of two elements A and B, two-site form.

As eam/cd, with $$h_{AB} = h\big(\tfrac12 (x_i + x_j)\big)$$.

Source: LAMMPS manual, pair_style eam; Stukowski, Sadigh, Erhart and Caro, Modell. Simul. Mater. Sci. Eng. 17, 075005 (2009).
"""
from __future__ import annotations

from asemd.pair.eam_cd import Concentration
from asemd.style import register

register(Concentration("eam/cd/old", 2, doc=__doc__))
