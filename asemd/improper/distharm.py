r"""$$E = K (d - d_0)^2$$

Spring in the oriented distance d of the first atom from the plane of the other three: positive where atoms 2, 3, 4 turn
counter-clockwise when seen from atom 1. Source: LAMMPS manual, improper_style distharm.
"""
from __future__ import annotations

from asemd.kernels.geometry import cross, low, plane_distance
from asemd.style import Style, improper


class ImproperDistharm(Style):
    def functions(self):
        return low, cross, plane_distance, self.function


@improper("distharm", cls=ImproperDistharm, example="25.0 0.3")
def distharm(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy/distance^2", d0: "distance"):
    d, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = plane_distance(ax, ay, az, bx, by, bz, cx, cy, cz)
    d -= d0
    s = 2.0 * K * d
    return K * d * d, s * gax, s * gay, s * gaz, s * gbx, s * gby, s * gbz, s * gcx, s * gcy, s * gcz
