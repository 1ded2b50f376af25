r"""$$E = \frac{K}{2 \sin^2 \omega_0} (\cos\omega - \cos\omega_0)^2, \qquad E = K (1 - \cos\omega) \; \text{if} \; \omega_0 = 0$$

Inversion of DREIDING: omega is the angle between the axis I-L and the plane of I, J, K. With omega0 = 0 the planar structure is
the minimum, else there are two minima and a barrier.
Source: Mayo, Olafson and Goddard, J. Phys. Chem. 94, 8897 (1990); LAMMPS manual, improper_style umbrella.
"""
from __future__ import annotations

import math

from asemd.style import improper


@improper("umbrella", example="100.0 35.0", equilibrium="omega0")
def umbrella(omega, K: "energy", omega0: "angle"):
    s = math.sin(omega)
    if omega0 == 0.0:
        h = math.sin(0.5 * omega)
        return 2.0 * K * h * h, K * s
    s0 = math.sin(omega0)
    d = -2.0 * math.sin(0.5 * (omega + omega0)) * math.sin(0.5 * (omega - omega0))     # cos(omega) - cos(omega0)
    c = K / (s0 * s0)
    return 0.5 * c * d * d, -c * d * s
