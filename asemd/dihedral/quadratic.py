r"""$$E = K (\phi - \phi_0)^2$$

Keeps a torsion near a given angle; the difference is taken the short way round for phi0 from -180 to 180 degrees (otherwise it is wrapped
once, as in LAMMPS). Opposite phi0 the force jumps. Source: LAMMPS manual, dihedral_style quadratic.
"""
from __future__ import annotations

import math

from asemd.style import dihedral


def quadratic_d2(phi, K, phi0):
    return 2.0 * K


@dihedral("quadratic", example="100.0 80.0", d2=quadratic_d2)
def quadratic(phi, K: "energy", phi0: "angle"):
    d = phi - phi0
    if phi > phi0 + math.pi:         # not of d, which is rounded
        d -= 2.0 * math.pi
    elif phi < phi0 - math.pi:
        d += 2.0 * math.pi
    return K * d * d, 2.0 * K * d
