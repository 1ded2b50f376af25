r"""$$E = \frac{K}{2 \sin^2 \omega_0} (\cos\omega - \cos\omega_0)^2, \qquad E = K (1 - \cos\omega) \; \text{if} \; \omega_0 = 0$$

Inversion of DREIDING: omega is the angle between the axis I-L and the plane of I, J, K, above 90 degrees when L leans over to the side of
J and K. With omega0 = 0 the planar structure is the minimum, else there are two minima and a barrier.
Source: Mayo, Olafson and Goddard, J. Phys. Chem. 94, 8897 (1990); LAMMPS manual, improper_style umbrella.
"""
from __future__ import annotations

import math

from asemd.kernels.geometry import cross, elevation, leans_over, low
from asemd.style import Style, improper


class ImproperUmbrella(Style):
    def functions(self):
        return low, cross, elevation, leans_over, self.function


@improper("umbrella", cls=ImproperUmbrella, example="100.0 35.0", equilibrium="omega0",
          domain="no bond of the first atom may have length 0")
def umbrella(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", omega0: "angle"):
    if not (ax * ax + ay * ay + az * az > 0.0 and bx * bx + by * by + bz * bz > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    chi, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = elevation(ax, ay, az, bx, by, bz, cx, cy, cz)
    omega, turn = chi, 1.0
    if leans_over(ax, ay, az, bx, by, bz, cx, cy, cz):
        omega, turn = math.pi - chi, -1.0
    if omega0 == 0.0:
        h = math.sin(0.5 * omega)
        e, d = 2.0 * K * h * h, turn * K * math.sin(chi)
    else:
        s0 = math.sin(omega0)
        u = -2.0 * math.sin(0.5 * (omega + omega0)) * math.sin(0.5 * (omega - omega0))     # cos(omega) - cos(omega0)
        k = K / (s0 * s0)
        e, d = 0.5 * k * u * u, -turn * k * u * math.sin(chi)
    return e, d * gax, d * gay, d * gaz, d * gbx, d * gby, d * gbz, d * gcx, d * gcy, d * gcz
