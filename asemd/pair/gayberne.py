r"""$$E = 4\epsilon(\varrho^{12} - \varrho^6)\,\eta^{\upsilon}\,\chi^{\mu}, \quad \varrho = \frac{\sigma}{h + \gamma\sigma}, \quad
    h = r - \left(\tfrac12 \hat r^T G^{-1} \hat r\right)^{-1/2}, \quad \eta^2 = \frac{2 s_1 s_2}{\det G}, \quad
    \chi = 2\,\hat r^T B^{-1} \hat r$$

Gay-Berne ellipsoids. With the semi-axes S and the relative well depths e of both bodies along the rows of A,
G is the sum of their A^T S^2 A and B that of A^T diag(e^(-1/mu)) A, s = (ab + cc) sqrt(ab) of the semi-axes.
Two types that are round, with equal well depths, interact as by lj/cut; points have semi-axes of 1. LAMMPS's torques on an ellipsoid by a
round one are without the exponent mu; ``compat="lammps"`` gives them.
Source: J. G. Gay, B. J. Berne, J. Chem. Phys. 74, 3316 (1981); R. Everaers, M. R. Ejtehadi, Phys. Rev. E 67, 041710 (2003).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.ellipsoid_pairs import EllipsoidPair
from asemd.kernels.pair_ellipsoid import inverse, skew, times
from asemd.style import register


def potential(d, r2, form, ti, tj, rows, constants, first, second, work, out):
    epsilon, sigma = rows[2, ti, tj], rows[3, ti, tj]
    gamma, upsilon, mu = constants[0], 0.5 * constants[1], constants[2]
    x, y, z = d[0], d[1], d[2]
    r = math.sqrt(r2)
    g, b = work[0], work[1]
    for k in range(6):
        work[2, k], work[3, k] = first[0, k] + second[0, k], first[1, k] + second[1, k]
    det = inverse(work[2], g)
    inverse(work[3], b)
    ux, uy, uz = times(g, x, y, z)
    wx, wy, wz = times(b, x, y, z)
    p, t = x * ux + y * uy + z * uz, x * wx + y * wy + z * wz
    ratio = math.sqrt(2.0 / p)          # of the distance of contact to r
    touch = r * ratio / p
    rho = sigma / (r - r * ratio + gamma * sigma)
    r6 = rho * rho * rho
    r6 = r6 * r6
    u = 4.0 * epsilon * (r6 * r6 - r6)
    du = -24.0 * epsilon * rho / sigma * (2.0 * r6 * r6 - r6)
    a, c = first[2], second[2]
    s1, s2 = (a[6] * a[7] + a[8] * a[8]) * math.sqrt(a[6] * a[7]), (c[6] * c[7] + c[8] * c[8]) * math.sqrt(c[6] * c[7])
    eta, chi = (2.0 * s1 * s2 / det) ** upsilon, (2.0 * t / r2) ** mu
    k = eta * chi * du
    v = 2.0 * mu * eta * chi * u
    n = v / t if form == 1.0 or constants[4] != 0.0 else 4.0 * eta * u / r2
    along = k * (1.0 - ratio) / r - v / r2
    out[0], out[1], out[2] = along * x + k * touch * ux + v / t * wx, along * y + k * touch * uy + v / t * wy, \
        along * z + k * touch * uz + v / t * wz
    for body in range(2):
        own = first if body == 0 else second
        if form == 2.0 and own[2, 0] == own[2, 1] == own[2, 2] and own[2, 3] == own[2, 4] == own[2, 5]:        # the round one
            out[3 + 3 * body] = out[4 + 3 * body] = out[5 + 3 * body] = 0.0
            continue
        gx, gy, gz = times(own[0], ux, uy, uz)
        bx, by, bz = times(own[1], wx, wy, wz)
        m = k * touch
        turn = -2.0 * upsilon * eta * chi * u
        nx, ny, nz = skew(own[0], g)
        out[3 + 3 * body] = m * (uy * gz - uz * gy) + n * (wy * bz - wz * by) + turn * nx
        out[4 + 3 * body] = m * (uz * gx - ux * gz) + n * (wz * bx - wx * bz) + turn * ny
        out[5 + 3 * body] = m * (ux * gy - uy * gx) + n * (wx * by - wy * bx) + turn * nz
    return eta * chi * u


class GayBerne(EllipsoidPair):
    def check_scene(self, interactions, system):
        self.learn({}, system)

    def bodies(self, settings, wells, ntypes):
        semi = 0.5 * self.shapes(settings, ntypes)
        semi[~semi.any(axis=1)] = 1.0
        depths = np.ones((ntypes + 1, 3))
        for t, e in wells.items():
            depths[t] = np.array(e) ** (-1.0 / settings["mu"])
        return np.hstack([semi**2, depths, semi])

    def form(self, i, j, bodies, settings):
        first, second = (bool(np.ptp(bodies[t, 6:])) or bool(np.ptp(bodies[t, 3:6])) for t in (i, j))
        return (0.0, 2.0, 1.0)[first + second]


register(GayBerne("gayberne", potential, settings="gamma upsilon mu cut", settings_example="1.0 3.0 1.0 5.0",
                  example="1.0 1.0 1.0 0.7 0.4 1.0 0.7 0.4 4.5", doc=__doc__))
