r"""$$E = \epsilon\left[\left(\frac{r_b}{r}\right)^4 - 2\left(\frac{r_b}{r}\right)^2\right] + (1 - \varphi)\,\epsilon \quad (r < r_b),
    \qquad E = -\epsilon \cos^{2\zeta}\left(\frac{\pi}{2} \frac{r - r_b}{r_c - r_b}\right) \varphi \quad (r_b \le r < r_c)$$

Particles that make up a fluid membrane, each for a patch of it with the normal n, which is the first axis of the body. rb is
$2^{1/6}\sigma$, rc the cutoff, and with beta, the sine of the angle that curves the membrane,

$$\varphi = 1 + \mu (a - 1), \quad a = (n_i \times \hat r)\cdot(n_j \times \hat r) + \beta (n_i - n_j)\cdot\hat r - \beta^2, \quad
    \vec r = \vec x_i - \vec x_j$$

2 zeta is cut off to a whole number, and is 2 at least, as in LAMMPS's energy.

Source: H. Yuan, C. Huang, J. Li, G. Lykotrafitis, S. Zhang, Phys. Rev. E 82, 011905 (2010); LAMMPS manual, pair_style ylz.
"""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asemd.ellipsoid_pairs import OrientedPair
from asemd.errors import InputError
from asemd.kernels.whole_power import whole_power
from asemd.style import register


def potential(d, r2, form, ti, tj, rows, constants, first, second, work, out):
    epsilon, mu, beta = rows[2, ti, tj], rows[7, ti, tj], rows[8, ti, tj]
    r, cut, near = math.sqrt(r2), math.sqrt(rows[0, ti, tj]), 1.122462048309373 * rows[3, ti, tj]
    x, y, z = d[0] / r, d[1] / r, d[2] / r
    ax, ay, az = first[3, 6], first[3, 7], first[3, 8]
    bx, by, bz = second[3, 6], second[3, 7], second[3, 8]
    c, e = ax * x + ay * y + az * z, bx * x + by * y + bz * z
    phi = 1.0 + mu * (ax * bx + ay * by + az * bz - c * e + beta * (c - e) - beta * beta - 1.0)
    if r < near:
        s2 = near * near / r2
        energy, slope, by_phi = epsilon * (s2 * s2 - 2.0 * s2) + (1.0 - phi) * epsilon, 4.0 * epsilon * (s2 - s2 * s2) / r, -epsilon
    else:
        rate = 0.5 * math.pi / (cut - near)
        cosine = math.cos(rate * (r - near))
        power = whole_power(cosine, int(rows[5, ti, tj]) - 1)
        by_phi = -epsilon * cosine * power
        energy = by_phi * phi
        slope = rows[6, ti, tj] * epsilon * power * math.sin(rate * (r - near)) * rate * phi
    k = by_phi * mu
    gx, gy, gz = (beta - e) * ax - (beta + c) * bx, (beta - e) * ay - (beta + c) * by, (beta - e) * az - (beta + c) * bz
    along = slope - k * (gx * x + gy * y + gz * z) / r
    out[0], out[1], out[2] = along * x + k * gx / r, along * y + k * gy / r, along * z + k * gz / r
    gx, gy, gz = bx + (beta - e) * x, by + (beta - e) * y, bz + (beta - e) * z
    out[3], out[4], out[5] = k * (ay * gz - az * gy), k * (az * gx - ax * gz), k * (ax * gy - ay * gx)
    gx, gy, gz = ax - (beta + c) * x, ay - (beta + c) * y, az - (beta + c) * z
    out[6], out[7], out[8] = k * (by * gz - bz * gy), k * (bz * gx - bx * gz), k * (bx * gy - by * gx)
    return energy


class YLZ(OrientedPair):
    shaped = False

    def check(self, coeff, settings):
        if coeff["sigma"] <= 0.0:
            raise InputError(f"pair_coeff ylz: sigma must be positive, got {coeff['sigma']:g}")

    def learn(self, settings, system):
        if "shape" not in system.extra:
            raise InputError("pair style ylz needs ellipsoids: use atom_style ellipsoid, or hybrid with it")
        if (points := system.extra["shape"][:, 0] == 0.0).any():
            raise InputError(f"pair style ylz: atom {system.id[points].min()} is a point without orientation, set its shape first")

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        tables = super().pack_pairs(settings, filled, ntypes, units, False)
        more = np.zeros((5, ntypes + 1, ntypes + 1))
        for (i, j), c in filled.items():
            power = max(2.0, math.trunc(2.0 * c["zeta"]))
            more[:, i, j] = more[:, j, i] = [1.0, power, power if self.exact else 2.0 * c["zeta"], c["mu"], c["beta"]]
        return replace(tables, rows=np.concatenate([tables.rows, more]), arrays=(np.zeros((ntypes + 1, 9)),))


register(YLZ("ylz", potential, settings="cut", coeff="epsilon sigma zeta mu beta cut", mix={}, units={"zeta": "", "mu": "", "beta": ""},
             settings_example="2.6", example="1.0 1.0 4.0 3.0 0.0 2.6", doc=__doc__))
