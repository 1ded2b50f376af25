r"""$$E = K_2 d^2 + K_4 d^4$$

Spring in the distance d of the first atom from the plane of the other three. Source: LAMMPS manual, improper_style distance.
"""
from __future__ import annotations

from asemd.kernels.geometry import cross, low, plane_distance
from asemd.style import Style, improper


class ImproperDistance(Style):
    def functions(self):
        return low, cross, plane_distance, self.function


@improper("distance", cls=ImproperDistance, example="80.0 30.0")
def distance(ax, ay, az, bx, by, bz, cx, cy, cz, K2: "energy/distance^2", K4: "energy/distance^4"):
    d, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = plane_distance(ax, ay, az, bx, by, bz, cx, cy, cz)
    d2 = d * d
    s = d * (2.0 * K2 + 4.0 * K4 * d2)
    return d2 * (K2 + K4 * d2), s * gax, s * gay, s * gaz, s * gbx, s * gby, s * gbz, s * gcx, s * gcy, s * gcz
