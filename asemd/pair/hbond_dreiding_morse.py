r"""$$E = D_0 \left[ e^{-2 \alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right] \cos^n \theta$$

Hydrogen bonds of DREIDING with a Morse function, see hbond/dreiding/lj, also for LAMMPS's force between the cutoffs.
Source: Y. Liu, V. S. Bryantsev, M. S. Diallo, W. A. Goddard, J. Am. Chem. Soc. 131, 2798 (2009).
"""
from __future__ import annotations

import math

from asemd.hydrogen_bond import hydrogen_bond


@hydrogen_bond("hbond/dreiding/morse", "D0 alpha r0", units={"D0": "energy", "alpha": "1/distance", "r0": "distance"},
               settings_example="2 9.0 11.0 90.0", example="2 i 3.88 1.7241379 2.9 2 8.0 9.5 85.0",
               see="LAMMPS manual, pair_style hbond/dreiding/morse")
def morse(r2, p):
    r = math.sqrt(r2)
    u = math.exp(-p[8] * (r - p[9]))
    return p[7] * u * (u - 2.0), -p[7] * p[8] * u * (u - 1.0) / r
