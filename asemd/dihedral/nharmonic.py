r"""$$E = \sum_{i=1}^{n} A_i \cos^{i-1}\phi$$

Polynomial in the cosine of the torsion angle, of any degree. Source: LAMMPS manual, dihedral_style nharmonic.
"""
from __future__ import annotations

import math

from asemd.series import SeriesStyle
from asemd.style import Parameter, dihedral


def nharmonic_d2(phi, first, count, terms):
    c, s = math.cos(phi), math.sin(phi)
    e = slope = bend = 0.0
    for k in range(int(count) - 1, -1, -1):
        bend = bend * c + 2.0 * slope
        slope = slope * c + e
        e = e * c + terms[int(first) + k, 0]
    return s * s * bend - c * slope


@dihedral("nharmonic", cls=SeriesStyle, count="n", term=(Parameter("A", "energy"),), example="3 10.0 20.0 30.0", d2=nharmonic_d2)
def nharmonic(phi, first, count, terms: "array"):
    c = math.cos(phi)
    e = slope = 0.0
    for k in range(int(count) - 1, -1, -1):
        slope = slope * c + e
        e = e * c + terms[int(first) + k, 0]
    return e, -math.sin(phi) * slope
