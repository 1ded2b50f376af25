r"""$$E = K [C_0 + C_1 \cos\theta + C_2 \cos 2\theta]$$

Angle of the universal force field (UFF). Source: Rappe et al., J. Am. Chem. Soc. 114, 10024 (1992); LAMMPS manual, angle_style fourier.
"""
from __future__ import annotations

import math

from asemd.style import angle


def rest(coeff):
    """Where both terms balance; straight, or folded, where the first one wins (LAMMPS then takes an angle without a meaning)."""
    if abs(coeff["C1"]) >= 4.0 * abs(coeff["C2"]):
        return 180.0 if coeff["C1"] >= 0.0 else 0.0
    return math.degrees(math.acos(-0.25 * coeff["C1"] / coeff["C2"]))


def fourier_d2(theta, K, C0, C1, C2):
    return -K * (C1 * math.cos(theta) + 4.0 * C2 * math.cos(2.0 * theta))


@angle("fourier", example="75.0 1.0 0.5 0.3", rest=rest, d2=fourier_d2)
def fourier(theta, K: "energy", C0, C1, C2):
    return K * (C0 + C1 * math.cos(theta) + C2 * math.cos(2.0 * theta)), -K * (C1 * math.sin(theta) + 2.0 * C2 * math.sin(2.0 * theta))
