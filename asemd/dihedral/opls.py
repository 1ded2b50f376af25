r"""$$E = \tfrac{1}{2} K_1 [1 + \cos\phi] + \tfrac{1}{2} K_2 [1 - \cos 2\phi]
    + \tfrac{1}{2} K_3 [1 + \cos 3\phi] + \tfrac{1}{2} K_4 [1 - \cos 4\phi]$$

Torsion of the OPLS force field. Source: Watkins and Jorgensen, J. Phys. Chem. A 105, 4118 (2001); LAMMPS manual, dihedral_style opls.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


@dihedral("opls", example="1.740 -0.157 0.279 0.900")
def opls(phi, K1: "energy", K2: "energy", K3: "energy", K4: "energy"):
    c1 = math.cos(0.5 * phi)          # (1 + cos(x)) / 2 = cos^2(x/2), (1 - cos(x)) / 2 = sin^2(x/2)
    s2 = math.sin(phi)
    c3 = math.cos(1.5 * phi)
    s4 = math.sin(2.0 * phi)
    slope = -0.5 * K1 * s2 + K2 * s4 - 1.5 * K3 * math.sin(3.0 * phi) + 2.0 * K4 * math.sin(4.0 * phi)
    return K1 * c1 * c1 + K2 * s2 * s2 + K3 * c3 * c3 + K4 * s4 * s4, slope
