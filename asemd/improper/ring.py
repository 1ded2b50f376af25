r"""$$E = \tfrac{1}{6} K \left( \cos\theta_{ijl} + \cos\theta_{ijk} + \cos\theta_{kjl} + 3 \cos\theta_0 \right)^6$$

Keeps the three bonds of atom J from becoming planar and leaves small vibrations alone. LAMMPS counts the angles between a bond towards
J and one away from it: theta0 is the supplement of the angle at rest, 70.5 for a tetrahedral centre.
Source: Destree et al., J. Chem. Phys. 112, 9632 (2000); LAMMPS manual, improper_style ring.
"""
from __future__ import annotations

import math

from asemd.kernels.geometry import angle_between
from asemd.style import Style, improper


class ImproperRing(Style):
    def functions(self):
        return angle_between, self.function


@improper("ring", cls=ImproperRing, example="80.0 70.5", centre=2, domain="no bond of the second atom may have length 0")
def ring(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", theta0: "angle"):
    if not (ax * ax + ay * ay + az * az > 0.0 and bx * bx + by * by + bz * bz > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    u, uax, uay, uaz, ubx, uby, ubz = angle_between(ax, ay, az, bx, by, bz)
    v, vax, vay, vaz, vcx, vcy, vcz = angle_between(ax, ay, az, cx, cy, cz)
    w, wbx, wby, wbz, wcx, wcy, wcz = angle_between(bx, by, bz, cx, cy, cz)
    if theta0 > 0.5 * math.pi:          # cos(u) - cos(r) = -2 sin((u + r)/2) sin((u - r)/2): small u and r keep their digits
        r = math.pi - theta0
        s = -2.0 * (math.sin(0.5 * (u + r)) * math.sin(0.5 * (u - r)) + math.sin(0.5 * (v + r)) * math.sin(0.5 * (v - r))
                    + math.sin(0.5 * (w + r)) * math.sin(0.5 * (w - r)))
    else:                               # cos(u) + cos(theta0) = 2 cos((u + theta0)/2) cos((u - theta0)/2)
        s = 2.0 * (math.cos(0.5 * (u + theta0)) * math.cos(0.5 * (u - theta0)) + math.cos(0.5 * (v + theta0)) * math.cos(0.5 * (v - theta0))
                   + math.cos(0.5 * (w + theta0)) * math.cos(0.5 * (w - theta0)))
    s2 = s * s
    k = -K * s2 * s2 * s
    su, sv, sw = k * math.sin(u), k * math.sin(v), k * math.sin(w)
    return (K * s2 * s2 * s2 / 6.0, su * uax + sv * vax, su * uay + sv * vay, su * uaz + sv * vaz, su * ubx + sw * wbx,
            su * uby + sw * wby, su * ubz + sw * wbz, sv * vcx + sw * wcx, sv * vcy + sw * wcy, sv * vcz + sw * wcz)
