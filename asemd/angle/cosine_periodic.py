r"""$$E = \frac{2 C}{n^2} [1 - B (-1)^n \cos(n \theta)]$$

Angle of the DREIDING force field for metal centres: n = 4 for octahedral ones, n = 3 for trigonal ones; B = 1 has a minimum at 180 degrees,
B = -1 a maximum. Source: Mayo, Olafson and Goddard, J. Phys. Chem. 94, 8897 (1990); LAMMPS manual, angle_style cosine/periodic.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import angle


def check(coeff, settings):
    if coeff["n"] < 1:
        raise InputError(f"angle_coeff cosine/periodic: n must be 1 or more, got {coeff['n']}")


def rest(coeff):
    """The widest angle of least energy."""
    return 180.0 if coeff["B"] == 1 else 180.0 - 180.0 / coeff["n"]


def cosine_periodic_d2(theta, C, B, n):
    return 2.0 * C * (B if n % 2.0 == 0.0 else -B) * math.cos(n * theta)


@angle("cosine/periodic", example="75.0 -1 3", rest=rest, check=check, d2=cosine_periodic_d2)
def cosine_periodic(theta, C: "energy", B: "integer", n: "integer"):
    wide = theta > 0.5 * math.pi
    # cos(n (pi - theta)) = (-1)^n cos(n theta), and n (pi - theta) keeps its digits near a straight angle
    a = n * (math.pi - theta + 1.2246467991473532e-16) if wide else n * theta
    b = B if wide or n % 2.0 == 0.0 else -B
    front = 2.0 * C / (n * n)
    s, c = math.sin(0.5 * a), math.cos(0.5 * a)
    slope = front * b * n * math.sin(a)
    e = 1.0 - b + 2.0 * b * s * s if b > 0.0 else 1.0 + b - 2.0 * b * c * c      # 1 - b cos(a), no digits cancel for B = 1 and -1
    return front * e, -slope if wide else slope
