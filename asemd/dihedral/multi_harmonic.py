r"""$$E = \sum_{n=1}^{5} A_n \cos^{n-1}\phi$$

Polynomial in the cosine of the torsion angle. Source: LAMMPS manual, dihedral_style multi/harmonic.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def multi_harmonic_d2(phi, A1, A2, A3, A4, A5):
    c, s = math.cos(phi), math.sin(phi)
    return s * s * (2.0 * A3 + c * (6.0 * A4 + 12.0 * c * A5)) - c * (A2 + c * (2.0 * A3 + c * (3.0 * A4 + 4.0 * c * A5)))


@dihedral("multi/harmonic", example="20.0 -10.0 5.0 7.0 -3.0", d2=multi_harmonic_d2)
def multi_harmonic(phi, A1: "energy", A2: "energy", A3: "energy", A4: "energy", A5: "energy"):
    c = math.cos(phi)
    slope = A2 + c * (2.0 * A3 + c * (3.0 * A4 + c * 4.0 * A5))
    return A1 + c * (A2 + c * (A3 + c * (A4 + c * A5))), -math.sin(phi) * slope
