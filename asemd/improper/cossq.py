r"""$$E = \tfrac{1}{2} K \cos^2(\chi - \chi_0)$$

chi is the angle between the vectors from atom I to J and from K to L, 0 to 180 degrees. Forces are minus the gradient of this energy;
LAMMPS leaves out a factor $\sin(\chi - \chi_0) / \sin\chi$: its forces agree for chi0 = 0, and are off by 12 % for 5 degrees and by half
of their size for 20 degrees (root mean square over random geometries); ``compat="lammps"`` gives them.
Source: LAMMPS manual, improper_style cossq.
"""
from __future__ import annotations

import math

from asemd.kernels.geometry import angle_between
from asemd.style import Style, improper


class ImproperCossq(Style):
    def functions(self):
        return angle_between, self.function


def without_chain_rule(ax, ay, az, bx, by, bz, cx, cy, cz, K, chi0):
    if not (ax * ax + ay * ay + az * az > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    chi, gx, gy, gz, hx, hy, hz = angle_between(ax, ay, az, cx, cy, cz)
    c = math.cos(chi - chi0)
    s = -K * c * math.sin(chi)
    return 0.5 * K * c * c, s * gx, s * gy, s * gz, 0.0, 0.0, 0.0, s * hx, s * hy, s * hz


@improper("cossq", cls=ImproperCossq, example="4.0 20.0", lammps=without_chain_rule, chain=True,
          domain="atoms 1 and 2, and atoms 3 and 4, must not be at the same place")
def cossq(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", chi0: "angle"):
    if not (ax * ax + ay * ay + az * az > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    chi, gx, gy, gz, hx, hy, hz = angle_between(ax, ay, az, cx, cy, cz)
    c = math.cos(chi - chi0)
    s = -K * c * math.sin(chi - chi0)
    return 0.5 * K * c * c, s * gx, s * gy, s * gz, 0.0, 0.0, 0.0, s * hx, s * hy, s * hz
