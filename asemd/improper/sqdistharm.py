r"""$$E = K (d^2 - d_0^2)^2$$

Double well in the distance d of the first atom from the plane of the other three; the second coefficient is the square of d0.
Source: LAMMPS manual, improper_style sqdistharm.
"""
from __future__ import annotations

from asemd.kernels.geometry import cross, low, plane_distance
from asemd.style import Style, improper


class ImproperSqdistharm(Style):
    def functions(self):
        return low, cross, plane_distance, self.function


@improper("sqdistharm", cls=ImproperSqdistharm, example="25.0 0.09")
def sqdistharm(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy/distance^4", d0_squared: "distance^2"):
    d, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = plane_distance(ax, ay, az, bx, by, bz, cx, cy, cz)
    q = d * d - d0_squared
    s = 4.0 * K * q * d
    return K * q * q, s * gax, s * gay, s * gaz, s * gbx, s * gby, s * gbz, s * gcx, s * gcy, s * gcz
