r"""$$E = \tfrac{1}{3} K \sum_{k=1}^{3} (\omega_k - \omega_0)^2$$

Inversion of MOF-FF: the three angles, 0 to 90 degrees, between a bond of the first atom and the plane of its other two bonds.
Source: Bureekaew et al., Phys. Status Solidi B 250, 1128 (2013); LAMMPS manual, improper_style inversion/harmonic.
"""
from __future__ import annotations

import math

from asemd.kernels.geometry import cross, elevation
from asemd.kernels.volume import low, tail, volume
from asemd.style import Style, improper


class ImproperInversion(Style):
    def functions(self):
        return low, tail, volume, cross, elevation, self.function


@improper("inversion/harmonic", cls=ImproperInversion, example="18.776 12.0", equilibrium="omega0", edge=True,
          domain="no bond of the first atom may have length 0")
def inversion_harmonic(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", omega0: "angle"):
    if not (ax * ax + ay * ay + az * az > 0.0 and bx * bx + by * by + bz * bz > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    u, uax, uay, uaz, ubx, uby, ubz, ucx, ucy, ucz = elevation(ax, ay, az, bx, by, bz, cx, cy, cz)
    v, vcx, vcy, vcz, vax, vay, vaz, vbx, vby, vbz = elevation(cx, cy, cz, ax, ay, az, bx, by, bz)
    w, wbx, wby, wbz, wcx, wcy, wcz, wax, way, waz = elevation(bx, by, bz, cx, cy, cz, ax, ay, az)
    du, dv, dw = abs(u) - omega0, abs(v) - omega0, abs(w) - omega0
    k, side = K / 3.0, u                                      # all three have the same sign
    if abs(u) < 1e-12:
        side = volume(ax, ay, az, bx, by, bz, cx, cy, cz)
    push = 2.0 * k if side >= 0.0 else -2.0 * k      # in the plane, `edge`, there is no direction to push to
    su, sv, sw = push * du, push * dv, push * dw
    return (k * (du * du + dv * dv + dw * dw), su * uax + sv * vax + sw * wax, su * uay + sv * vay + sw * way,
            su * uaz + sv * vaz + sw * waz, su * ubx + sv * vbx + sw * wbx, su * uby + sv * vby + sw * wby,
            su * ubz + sv * vbz + sw * wbz, su * ucx + sv * vcx + sw * wcx, su * ucy + sv * vcy + sw * wcy,
            su * ucz + sv * vcz + sw * wcz)
