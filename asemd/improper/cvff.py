r"""$$E = K [1 + d \cos(n \phi)]$$

Periodic in the angle between the planes of atoms I, J, K and J, K, L; d is 1 or -1, n 0 to 6. Source: LAMMPS manual, improper_style cvff.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import improper


def check(coeff, settings):
    if coeff["d"] not in (1, -1):
        raise InputError(f"improper_coeff cvff: incorrect sign, d must be 1 or -1, got {coeff['d']}")
    if not 0 <= coeff["n"] <= 6:
        raise InputError(f"improper_coeff cvff: incorrect multiplicity, n must be 0 to 6, got {coeff['n']}")


def cvff_d2(phi, K, d, n):
    return -K * d * n * n * math.cos(n * phi)


@improper("cvff", example="80.0 -1 4", check=check, d2=cvff_d2)
def cvff(phi, K: "energy", d: "integer", n: "integer"):
    c = math.cos(0.5 * n * phi) if d > 0.0 else math.sin(0.5 * n * phi)     # 1 + cos(x) = 2 cos^2(x/2), 1 - cos(x) = 2 sin^2(x/2)
    return 2.0 * K * c * c, -K * d * n * math.sin(n * phi)
