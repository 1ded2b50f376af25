r"""$$E = \tfrac{1}{2} K_1 [1 + \cos\phi] + \tfrac{1}{2} K_2 [1 - \cos 2\phi]
    + \tfrac{1}{2} K_3 [1 + \cos 3\phi] + \tfrac{1}{2} K_4 [1 - \cos 4\phi]$$

Torsion of the OPLS force field. Source: Watkins and Jorgensen, J. Phys. Chem. A 105, 4118 (2001); LAMMPS manual, dihedral_style opls.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def opls_d2(phi, K1, K2, K3, K4):
    first = -0.5 * K1 * math.cos(phi) + 2.0 * K2 * math.cos(2.0 * phi)
    return first - 4.5 * K3 * math.cos(3.0 * phi) + 8.0 * K4 * math.cos(4.0 * phi)


@dihedral("opls", example="1.740 -0.157 0.279 0.900", d2=opls_d2)
def opls(phi, K1: "energy", K2: "energy", K3: "energy", K4: "energy"):
    # (1 + cos(x)) / 2 = cos^2(x/2), (1 - cos(x)) / 2 = sin^2(x/2); the forces of all terms have the factor sin(phi)
    h, c, s = math.cos(0.5 * phi), math.cos(phi), math.sin(phi)
    h3 = h * (2.0 * c - 1.0)
    s4 = 2.0 * s * c
    slope = s * (-0.5 * K1 + 2.0 * K2 * c - 1.5 * K3 * (2.0 * c - 1.0) * (2.0 * c + 1.0) + 8.0 * K4 * c * (c - s) * (c + s))
    return K1 * h * h + K2 * s * s + K3 * h3 * h3 + K4 * s4 * s4, slope
