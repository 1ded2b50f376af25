r"""$$E = A [1 - \cos\phi] + B [1 + \cos 3\phi] + C [1 + \cos(\phi + \pi/4)]$$

Torsion of coarse-grained proteins with minima at trans and gauche, the third term prefers one hand of the helix.
Source: Guo and Thirumalai, J. Mol. Biol. 263, 323 (1996); LAMMPS manual, dihedral_style helix.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def helix_d2(phi, A, B, C):
    return A * math.cos(phi) - 9.0 * B * math.cos(3.0 * phi) - C * math.cos(phi + 0.25 * math.pi)


@dihedral("helix", example="80.0 100.0 40.0", d2=helix_d2)
def helix(phi, A: "energy", B: "energy", C: "energy"):
    s = math.sin(0.5 * phi)           # 1 - cos(x) = 2 sin^2(x/2), 1 + cos(x) = 2 cos^2(x/2)
    c3 = math.cos(1.5 * phi)
    c = math.cos(0.5 * phi + 0.125 * math.pi)
    t = 2.0 * math.cos(phi)
    slope = math.sin(phi) * (A - 3.0 * B * (t - 1.0) * (t + 1.0)) - C * math.sin(phi + 0.25 * math.pi)
    return 2.0 * (A * s * s + B * c3 * c3 + C * c * c), slope
