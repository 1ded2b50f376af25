r"""$$E = K [1 + d \cos(n \phi)]$$

Periodic torsion; d is 1 or -1, n a whole number, and phi = 180 degrees is trans. Three atoms on a line have the mean energy K.
Source: LAMMPS manual, dihedral_style harmonic.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import dihedral


def check(coeff, settings):
    if coeff["d"] not in (1, -1):
        raise InputError(f"dihedral_coeff harmonic: incorrect sign, d must be 1 or -1, got {coeff['d']}")
    if coeff["n"] < 0:
        raise InputError(f"dihedral_coeff harmonic: incorrect multiplicity, n must be 0 or more, got {coeff['n']}")


def harmonic_d2(phi, K, d, n):
    return -K * d * n * n * math.cos(n * phi)


def on_line(K, d, n):
    return K * (1.0 + d) if n == 0.0 else K


@dihedral("harmonic", example="80.0 1 2", check=check, d2=harmonic_d2, straight=on_line)
def harmonic(phi, K: "energy", d: "integer", n: "integer"):
    c = math.cos(0.5 * n * phi) if d > 0.0 else math.sin(0.5 * n * phi)     # 1 + cos(x) = 2 cos^2(x/2), 1 - cos(x) = 2 sin^2(x/2)
    return 2.0 * K * c * c, -K * d * n * math.sin(n * phi)
