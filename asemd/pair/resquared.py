r"""$$E = -\frac{A}{36}\Bigl(1 + 3\eta\chi\frac{\sigma}{h}\Bigr) \prod_{i,k} \frac{s_{ik}}{s_{ik} + h/2}
    + \frac{A}{2025}\Bigl(\frac{\sigma}{h}\Bigr)^6 \Bigl(1 + \frac{45}{56}\eta\chi\frac{\sigma}{h}\Bigr)
    \prod_{i,k} \frac{s_{ik}}{s_{ik} + h/60^{1/3}}$$

RE-squared ellipsoids: bodies made of Lennard-Jones spheres of diameter sigma, with semi-axes s and Hamaker constant A (the coefficient
epsilon). h is the distance less that of contact and chi as in gayberne, with the relative well depths themselves in place of their powers;

$$\eta = \frac{\det S_1/\sigma_1^2 + \det S_2/\sigma_2^2}{\sqrt{\det H / (\sigma_1 + \sigma_2)}}, \quad
    H = \frac{G_1}{\sigma_1} + \frac{G_2}{\sigma_2}, \quad \sigma_i = (\hat r^T G_i^{-1} \hat r)^{-1/2}$$

Points are single spheres of diameter sigma, two of them interact as by lj/cut with epsilon = A; with an ellipsoid, eta is 1 and its product
becomes that of one body, times $3/4\pi$ and $(2\sigma/h)^3$ or $60(\sigma/h)^3$, and contact is that of semi-axes s + sigma/2. Coefficients
of unlike types must be given: those of ellipsoids have no mean, and points whose coefficients LAMMPS mixes do not interact there.
Source: R. Everaers, M. R. Ejtehadi, Phys. Rev. E 67, 041710 (2003); M. Babadi, R. Everaers, M. R. Ejtehadi, J. Chem. Phys. 124, 174708.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.ellipsoid_pairs import EllipsoidPair
from asemd.kernels.pair_ellipsoid import inverse, skew, times, trace
from asemd.style import register


def potential(d, r2, form, ti, tj, rows, constants, first, second, work, out):
    a12, sigma = rows[2, ti, tj], rows[3, ti, tj]
    x, y, z = d[0], d[1], d[2]
    r = math.sqrt(r2)
    one = second if form == 3.0 else first          # the ellipsoid, of an ellipsoid and a point
    g, b, h_inverse, both = work[0], work[1], work[2], work[3]
    for k in range(9):
        out[k] = 0.0
    # contact, and the local well depth
    if form == 1.0:
        for k in range(6):
            both[k] = first[0, k] + second[0, k]
        inverse(both, g)
        for k in range(6):
            both[k] = first[1, k] + second[1, k]
        share = 2.0
    else:
        for k in range(6):
            both[k] = one[0, k] + sigma * one[3, k] + (0.25 * sigma * sigma if k < 3 else 0.0)
        inverse(both, g)
        for k in range(6):
            both[k] = one[1, k] + (1.0 if k < 3 else 0.0)
        share = 1.0
    inverse(both, b)
    ux, uy, uz = times(g, x, y, z)
    wx, wy, wz = times(b, x, y, z)
    p, t = x * ux + y * uy + z * uz, x * wx + y * wy + z * wz
    ratio = math.sqrt(share / p)
    touch = r * ratio / p
    h = r - r * ratio
    chi, eta = 2.0 * t / r2, 1.0
    # curvature of both at the contact
    e1 = e2 = q1 = q2 = l1 = l2 = 0.0
    if form == 1.0:
        s1, s2 = first[2], second[2]
        inverse(first[0], both)
        ax, ay, az = times(both, x, y, z)
        inverse(second[0], both)
        cx, cy, cz = times(both, x, y, z)
        q1, q2 = x * ax + y * ay + z * az, x * cx + y * cy + z * cz
        e1, e2 = r / math.sqrt(q1), r / math.sqrt(q2)
        for k in range(6):
            both[k] = first[0, k] / e1 + second[0, k] / e2
        det = inverse(both, h_inverse)
        d1, d2 = s1[6] * s1[7] * s1[8] / (e1 * e1), s2[6] * s2[7] * s2[8] / (e2 * e2)
        eta = (d1 + d2) / math.sqrt(det / (e1 + e2))
        l1 = -2.0 * d1 / (e1 * (d1 + d2)) + 0.5 * trace(h_inverse, first[0]) / (e1 * e1) + 0.5 / (e1 + e2)
        l2 = -2.0 * d2 / (e2 * (d1 + d2)) + 0.5 * trace(h_inverse, second[0]) / (e2 * e2) + 0.5 / (e1 + e2)
    # attraction and repulsion, their slopes by h and by ln(eta chi)
    s = sigma / h
    s3, depth, shallow, slope, steep = s * s * s, 1.0, 1.0, 0.0, 0.0
    root = 60.0 ** (1.0 / 3.0)
    for body in range(2):
        own = first if body == 0 else second
        if form == 1.0 or (form == 2.0) == (body == 0):
            for k in range(6, 9):
                semi = own[2, k]
                depth *= 2.0 * semi / (2.0 * semi + h)
                shallow *= root * semi / (root * semi + h)
                slope -= 1.0 / (2.0 * semi + h)
                steep -= 1.0 / (root * semi + h)
    tau = eta * chi * s
    attraction, repulsion = -a12 / 36.0 * depth, a12 / 2025.0 * s3 * s3 * shallow
    steep -= 6.0 / h
    if form != 1.0:
        attraction *= 1.9098593171027440292 * s3        # 6 / pi
        repulsion *= 14.323944878270580219 * s3         # 45 / pi
        slope -= 3.0 / h
        steep -= 3.0 / h
    by_log = (3.0 * attraction + 45.0 / 56.0 * repulsion) * tau
    energy_a, energy_r = attraction * (1.0 + 3.0 * tau), repulsion * (1.0 + 45.0 / 56.0 * tau)
    by_h = energy_a * slope + energy_r * steep - by_log / h
    along = by_h * (1.0 - ratio) / r - 2.0 * by_log / r2
    m, n = by_h * touch, 2.0 * by_log / t
    out[0], out[1], out[2] = along * x + m * ux + n * wx, along * y + m * uy + n * wy, along * z + m * uz + n * wz
    for body in range(2):
        own = first if body == 0 else second
        if form != 1.0 and (form == 2.0) != (body == 0):
            continue
        if form == 1.0:
            gx, gy, gz = times(own[0], ux, uy, uz)
        else:
            gx, gy, gz = x, y, z
        bx, by, bz = times(own[1], wx, wy, wz)
        tx = m * (uy * gz - uz * gy) + n * (wy * bz - wz * by)
        ty = m * (uz * gx - ux * gz) + n * (wz * bx - wx * bz)
        tz = m * (ux * gy - uy * gx) + n * (wx * by - wy * bx)
        if form == 1.0:
            e, q, slope_e = (e1, q1, l1) if body == 0 else (e2, q2, l2)
            vx, vy, vz = (ax, ay, az) if body == 0 else (cx, cy, cz)
            nx, ny, nz = skew(own[0], h_inverse)
            k1, k2 = by_log * slope_e * e, by_log / e
            out[0] += k1 * (x / r2 - vx / q)
            out[1] += k1 * (y / r2 - vy / q)
            out[2] += k1 * (z / r2 - vz / q)
            tx -= k1 / q * (vy * z - vz * y) + k2 * nx
            ty -= k1 / q * (vz * x - vx * z) + k2 * ny
            tz -= k1 / q * (vx * y - vy * x) + k2 * nz
        out[3 + 3 * body], out[4 + 3 * body], out[5 + 3 * body] = tx, ty, tz
    return energy_a + energy_r


class ReSquared(EllipsoidPair):
    def bodies(self, settings, wells, ntypes):
        semi, depths = 0.5 * self.shapes(settings, ntypes), np.ones((ntypes + 1, 3))
        for t, e in wells.items():
            depths[t] = e
        return np.hstack([semi**2, depths, semi])

    def form(self, i, j, bodies, settings):
        return {(False, False): 0.0, (True, True): 1.0, (True, False): 2.0, (False, True): 3.0}[bodies[i, 6] > 0.0, bodies[j, 6] > 0.0]


register(ReSquared("resquared", potential, settings="cut", settings_example="5.0", example="1.0 1.0 1.0 0.7 0.4 1.0 0.7 0.4 4.5",
                   mix={}, doc=__doc__))
