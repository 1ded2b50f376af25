r"""$$E = K [C_0 + C_1 \cos\omega + C_2 \cos(2 \omega)]$$

omega is the angle between the axis I-L and the plane of I, J, K, above 90 degrees when L leans over to the side of J and K. With ``all``
not 0 (the default) the two other choices of axis and plane are added. Source: LAMMPS manual, improper_style fourier; UFF: Rappe et al.,
J. Am. Chem. Soc. 114, 10024 (1992).
"""
from __future__ import annotations

import math

from asemd.kernels.geometry import cross, elevation, leans_over, low
from asemd.style import Parameter, Style, improper


class ImproperFourier(Style):
    def parse_coeff(self, words, settings):
        return {"all": 1, **super().parse_coeff(words, settings)}

    def functions(self):
        return low, cross, elevation, leans_over, inversion, self.function


def inversion(ax, ay, az, bx, by, bz, cx, cy, cz, C0, C1, C2):
    """Energy of c as the axis and a, b in the plane, over K, and its derivatives."""
    chi, gax, gay, gaz, gbx, gby, gbz, gcx, gcy, gcz = elevation(ax, ay, az, bx, by, bz, cx, cy, cz)
    turned = -C1 if leans_over(ax, ay, az, bx, by, bz, cx, cy, cz) else C1
    h, s = math.sin(0.5 * chi), math.sin(chi)
    e = C0 + turned + C2 - 2.0 * (turned * h * h + C2 * s * s)       # cos(x) = 1 - 2 sin^2(x/2): exact near the plane
    d = -s * (turned + 4.0 * C2 * math.cos(chi))
    return e, d * gax, d * gay, d * gaz, d * gbx, d * gby, d * gbz, d * gcx, d * gcy, d * gcz


@improper("fourier", cls=ImproperFourier, example="3.0 1.0 0.5 0.7 1", domain="no bond of the first atom may have length 0",
          coeff=(Parameter("K", "energy"), Parameter("C0"), Parameter("C1"), Parameter("C2"), Parameter("all", "integer", True)))
def fourier(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", C0, C1, C2, all: "integer"):
    if not (ax * ax + ay * ay + az * az > 0.0 and bx * bx + by * by + bz * bz > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    e, fax, fay, faz, fbx, fby, fbz, fcx, fcy, fcz = inversion(ax, ay, az, bx, by, bz, cx, cy, cz, C0, C1, C2)
    if all != 0.0:
        u, gcx, gcy, gcz, gax, gay, gaz, gbx, gby, gbz = inversion(cx, cy, cz, ax, ay, az, bx, by, bz, C0, C1, C2)
        v, hbx, hby, hbz, hcx, hcy, hcz, hax, hay, haz = inversion(bx, by, bz, cx, cy, cz, ax, ay, az, C0, C1, C2)
        e, fax, fay, faz = e + u + v, fax + gax + hax, fay + gay + hay, faz + gaz + haz
        fbx, fby, fbz, fcx, fcy, fcz = fbx + gbx + hbx, fby + gby + hby, fbz + gbz + hbz, fcx + gcx + hcx, fcy + gcy + hcy, fcz + gcz + hcz
    return K * e, K * fax, K * fay, K * faz, K * fbx, K * fby, K * fbz, K * fcx, K * fcy, K * fcz
