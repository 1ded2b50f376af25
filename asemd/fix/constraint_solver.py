r"""Compiled: forces that hold distances, by SHAKE's iteration, by SETTLE in one go, and by RATTLE for velocities.

A cluster has up to three distances. The force :math:`\lambda_k r_k` along each (old) distance vector :math:`r_k` is sought, such that the
new vectors :math:`s_k + \sum_j M_{kj} \lambda_j r_j` have the lengths :math:`d_k`, with inverse masses in :math:`M`. SHAKE solves

.. math:: 2 \sum_j M_{kj} (s_k \cdot r_j) \lambda_j = d_k^2 - s_k^2 - \Big|\sum_j M_{kj} \lambda_j r_j\Big|^2

with the last iteration's :math:`\lambda` on the right, from zero on, until no :math:`\lambda` changes by more than the tolerance. One
distance alone is a quadratic equation.

Source: J.-P. Ryckaert, G. Ciccotti, H. J. C. Berendsen, J. Comput. Phys. 23, 327 (1977); H. C. Andersen, J. Comput. Phys. 52, 24 (1983);
S. Miyamoto, P. A. Kollman, J. Comput. Chem. 13, 952 (1992); LAMMPS manual, fix shake.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.threads import barrier


def held_dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def held_minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def held_cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def held_shift(d, cell, straight):
    """What is to be taken from a vector to make it its closest image (bonds are short: rounding in the reduced cell is right)."""
    if straight:
        return (cell.lengths[0] * np.rint(d[0] * cell.inverse_lengths[0]), cell.lengths[1] * np.rint(d[1] * cell.inverse_lengths[1]),
                cell.lengths[2] * np.rint(d[2] * cell.inverse_lengths[2]))
    a, i = cell.reduced, cell.reduced_inverse
    p = np.rint(d[0] * i[0, 0] + d[1] * i[1, 0] + d[2] * i[2, 0])
    q = np.rint(d[0] * i[0, 1] + d[1] * i[1, 1] + d[2] * i[2, 1])
    r = np.rint(d[0] * i[0, 2] + d[1] * i[1, 2] + d[2] * i[2, 2])
    return (p * a[0, 0] + q * a[1, 0] + r * a[2, 0], p * a[0, 1] + q * a[1, 1] + r * a[2, 1], p * a[0, 2] + q * a[1, 2] + r * a[2, 2])


def hold_one(w, rr, sr, excess):
    """One distance: the smaller root; the second number is below zero if there is none."""
    a, b = w * w * rr, 2.0 * w * sr
    determinant = b * b + 4.0 * a * excess
    root = math.sqrt(max(determinant, 0.0))
    first, second = (-b + root) / (2.0 * a), (-b - root) / (2.0 * a)
    return first if abs(first) <= abs(second) else second, determinant


def hold_two(m, g, t, e, tolerance, most):
    """Two distances: m = M11 M12 M22, g = products of the r, t = s1.r1 s1.r2 s2.r1 s2.r2, e = what the squares lack."""
    a, b, c, d = 2.0 * m[0] * t[0], 2.0 * m[1] * t[1], 2.0 * m[1] * t[2], 2.0 * m[2] * t[3]
    determinant = a * d - b * c
    inverse = 1.0 / determinant
    p1, p2, p3 = m[0] * m[0] * g[0], 2.0 * m[0] * m[1] * g[1], m[1] * m[1] * g[2]
    q1, q2, q3 = m[1] * m[1] * g[0], 2.0 * m[1] * m[2] * g[1], m[2] * m[2] * g[2]
    x = y = 0.0
    for _ in range(most):
        u = e[0] - (p1 * x * x + p2 * x * y + p3 * y * y)
        v = e[1] - (q1 * x * x + q2 * x * y + q3 * y * y)
        x1, y1 = (d * u - b * v) * inverse, (a * v - c * u) * inverse
        done = abs(x1 - x) <= tolerance and abs(y1 - y) <= tolerance
        x, y = x1, y1
        if done or abs(x) > 1e150 or abs(y) > 1e150:
            break
    return x, y, determinant


def hold_linear(a, b, c, u):
    """Solution of three linear equations with rows a b c, and the determinant."""
    bc, ca, ab = held_cross(b, c), held_cross(c, a), held_cross(a, b)
    determinant = held_dot(a, bc)
    inverse = 1.0 / determinant
    return ((bc[0] * u[0] + ca[0] * u[1] + ab[0] * u[2]) * inverse, (bc[1] * u[0] + ca[1] * u[1] + ab[1] * u[2]) * inverse,
            (bc[2] * u[0] + ca[2] * u[1] + ab[2] * u[2]) * inverse, determinant)


def hold_three(m, r1, r2, r3, s1, s2, s3, e, tolerance, most):
    """Three distances: m = M11 M22 M33 M12 M13 M23."""
    row1, row2, row3 = (m[0], m[3], m[4]), (m[3], m[1], m[5]), (m[4], m[5], m[2])
    a = (2.0 * m[0] * held_dot(s1, r1), 2.0 * m[3] * held_dot(s1, r2), 2.0 * m[4] * held_dot(s1, r3))
    b = (2.0 * m[3] * held_dot(s2, r1), 2.0 * m[1] * held_dot(s2, r2), 2.0 * m[5] * held_dot(s2, r3))
    c = (2.0 * m[4] * held_dot(s3, r1), 2.0 * m[5] * held_dot(s3, r2), 2.0 * m[2] * held_dot(s3, r3))
    bc, ca, ab = held_cross(b, c), held_cross(c, a), held_cross(a, b)
    determinant = held_dot(a, bc)
    inverse = 1.0 / determinant
    g = (held_dot(r1, r1), held_dot(r2, r2), held_dot(r3, r3), 2.0 * held_dot(r1, r2), 2.0 * held_dot(r1, r3), 2.0 * held_dot(r2, r3))
    x = y = z = 0.0
    for _ in range(most):
        h0, h1, h2, h3, h4, h5 = x * x * g[0], y * y * g[1], z * z * g[2], x * y * g[3], x * z * g[4], y * z * g[5]
        u = e[0] - (row1[0] * (row1[0] * h0 + row1[1] * h3 + row1[2] * h4) + row1[1] * (row1[1] * h1 + row1[2] * h5)
                    + row1[2] * row1[2] * h2)
        v = e[1] - (row2[0] * (row2[0] * h0 + row2[1] * h3 + row2[2] * h4) + row2[1] * (row2[1] * h1 + row2[2] * h5)
                    + row2[2] * row2[2] * h2)
        w = e[2] - (row3[0] * (row3[0] * h0 + row3[1] * h3 + row3[2] * h4) + row3[1] * (row3[1] * h1 + row3[2] * h5)
                    + row3[2] * row3[2] * h2)
        x1 = (bc[0] * u + ca[0] * v + ab[0] * w) * inverse
        y1 = (bc[1] * u + ca[1] * v + ab[1] * w) * inverse
        z1 = (bc[2] * u + ca[2] * v + ab[2] * w) * inverse
        done = abs(x1 - x) <= tolerance and abs(y1 - y) <= tolerance and abs(z1 - z) <= tolerance
        x, y, z = x1, y1, z1
        if done or abs(x) > 1e150 or abs(y) > 1e150 or abs(z) > 1e150:
            break
    return x, y, z, determinant


def hold_triangle(b0, c0, b1, c1, m0, mh, length, base):
    """SETTLE: by how much each atom of a rigid triangle moves. Old and new vectors from the apex to both ends."""
    share = mh / (m0 + 2.0 * mh)
    a1 = (-share * (b1[0] + c1[0]), -share * (b1[1] + c1[1]), -share * (b1[2] + c1[2]))      # apex from the new centre of mass
    p1, q1 = (a1[0] + b1[0], a1[1] + b1[1], a1[2] + b1[2]), (a1[0] + c1[0], a1[1] + c1[1], a1[2] + c1[2])
    half = 0.5 * base
    height = math.sqrt(length * length - half * half)
    ra = 2.0 * share * height
    rb = height - ra
    z = held_cross(b0, c0)
    x = held_cross(a1, z)
    y = held_cross(z, x)
    lx, ly, lz = 1.0 / math.sqrt(held_dot(x, x)), 1.0 / math.sqrt(held_dot(y, y)), 1.0 / math.sqrt(held_dot(z, z))
    bx, by, cx, cy = held_dot(b0, x) * lx, held_dot(b0, y) * ly, held_dot(c0, x) * lx, held_dot(c0, y) * ly
    az, px, py, pz = held_dot(a1, z) * lz, held_dot(p1, x) * lx, held_dot(p1, y) * ly, held_dot(p1, z) * lz
    qx, qy, qz = held_dot(q1, x) * lx, held_dot(q1, y) * ly, held_dot(q1, z) * lz
    sin_phi = az / ra
    cos_phi = math.sqrt(1.0 - sin_phi * sin_phi)
    sin_psi = (pz - qz) / (base * cos_phi)
    cos_psi = math.sqrt(1.0 - sin_psi * sin_psi)
    ay, ux = ra * cos_phi, -half * cos_psi
    uy, vy = -rb * cos_phi - half * sin_psi * sin_phi, -rb * cos_phi + half * sin_psi * sin_phi
    alpha = ux * (bx - cx) + by * uy + cy * vy
    beta = ux * (cy - by) + bx * uy + cx * vy
    gamma = bx * py - px * by + cx * qy - qx * cy
    square = alpha * alpha + beta * beta
    sin_t = (alpha * gamma - beta * math.sqrt(square - gamma * gamma)) / square
    cos_t = math.sqrt(1.0 - sin_t * sin_t)
    fa, fb, fc = (-ay * sin_t, ay * cos_t), (ux * cos_t - uy * sin_t, ux * sin_t + uy * cos_t), (-ux * cos_t - vy * sin_t,
                                                                                           -ux * sin_t + vy * cos_t)
    ax, bx, cx = (fa[0] - held_dot(a1, x) * lx) * lx, (fb[0] - px) * lx, (fc[0] - qx) * lx
    ay, by, cy = (fa[1] - held_dot(a1, y) * ly) * ly, (fb[1] - py) * ly, (fc[1] - qy) * ly
    return ((ax * x[0] + ay * y[0], ax * x[1] + ay * y[1], ax * x[2] + ay * y[2]),
            (bx * x[0] + by * y[0], bx * x[1] + by * y[1], bx * x[2] + by * y[2]),
            (cx * x[0] + cy * y[0], cx * x[1] + cy * y[1], cx * x[2] + cy * y[2]))


def held_masses(kind, i0, i1, i2, i3):
    """M11 M22 M33 M12 M13 M23 of a cluster with these inverse masses; kinds 1 and 5 have their third distance between the ends."""
    if kind == 4:
        return i0 + i1, i0 + i2, i0 + i3, i0, i0, i0
    return i0 + i1, i0 + i2, i1 + i2, i0, -i1, i2


def hold_positions(th, s, p, a, step, ahead):
    """Add forces that keep the distances when x becomes ``x + step v + ahead f / m``; every thread has its share of the clusters.

    ``p`` and ``a`` are those of `asemd.fix.shake.Shake`.
    """
    barrier(th)
    atoms, kinds, lengths, virials = a[0], a[1], a[2], a[3]
    tolerance, most, mass_unit, straight = p[2], int(p[3]), p[4], p[5] != 0.0
    m = kinds.shape[0]
    square = ahead / mass_unit          # lambda / square is a force
    for c in range(m * th.tid // th.nth, m * (th.tid + 1) // th.nth):
        kind = kinds[c]
        k0, k1 = s.slot[atoms[c, 0]], s.slot[atoms[c, 1]]
        k2 = s.slot[atoms[c, 2]] if kind != 2 else k1
        k3 = s.slot[atoms[c, 3]] if kind == 4 else k1
        w0, w1, w2, w3 = s.inverse_mass[k0], s.inverse_mass[k1], s.inverse_mass[k2], s.inverse_mass[k3]
        x0 = (s.x[0, k0], s.x[1, k0], s.x[2, k0])
        d0 = (step * s.v[0, k0] + ahead * w0 * s.f[0, k0], step * s.v[1, k0] + ahead * w0 * s.f[1, k0],
              step * s.v[2, k0] + ahead * w0 * s.f[2, k0])
        r1 = (x0[0] - s.x[0, k1], x0[1] - s.x[1, k1], x0[2] - s.x[2, k1])
        r1 = held_minus(r1, held_shift(r1, s.box.cell, straight))
        s1 = (r1[0] + d0[0] - (step * s.v[0, k1] + ahead * w1 * s.f[0, k1]), r1[1] + d0[1] - (step * s.v[1, k1] + ahead * w1 * s.f[1, k1]),
              r1[2] + d0[2] - (step * s.v[2, k1] + ahead * w1 * s.f[2, k1]))
        w0, w1, w2, w3 = w0 * mass_unit, w1 * mass_unit, w2 * mass_unit, w3 * mass_unit
        e1 = lengths[c, 0] * lengths[c, 0] - held_dot(s1, s1)
        if kind == 2:
            l1, determinant = hold_one(w0 + w1, held_dot(r1, r1), held_dot(s1, r1), e1)
            if determinant < 0.0:
                p[6] += 1.0
            l1 /= square
            for d in range(3):
                s.f[d, k0] += l1 * r1[d]
                s.f[d, k1] -= l1 * r1[d]
            virials[c, 0], virials[c, 1], virials[c, 2] = l1 * r1[0] * r1[0], l1 * r1[1] * r1[1], l1 * r1[2] * r1[2]
            virials[c, 3], virials[c, 4], virials[c, 5] = l1 * r1[0] * r1[1], l1 * r1[0] * r1[2], l1 * r1[1] * r1[2]
        else:
            r2 = (x0[0] - s.x[0, k2], x0[1] - s.x[1, k2], x0[2] - s.x[2, k2])
            r2 = held_minus(r2, held_shift(r2, s.box.cell, straight))
            v2 = w2 / mass_unit
            s2 = (r2[0] + d0[0] - (step * s.v[0, k2] + ahead * v2 * s.f[0, k2]),
                  r2[1] + d0[1] - (step * s.v[1, k2] + ahead * v2 * s.f[1, k2]),
                  r2[2] + d0[2] - (step * s.v[2, k2] + ahead * v2 * s.f[2, k2]))
            e2 = lengths[c, 1] * lengths[c, 1] - held_dot(s2, s2)
            if kind == 5:
                b0, c0 = (-r1[0], -r1[1], -r1[2]), (-r2[0], -r2[1], -r2[2])
                t0, t1, t2 = hold_triangle(b0, c0, (-s1[0], -s1[1], -s1[2]), (-s2[0], -s2[1], -s2[2]), 1.0 / w0, 1.0 / w1, lengths[c, 0],
                                     lengths[c, 2])
                u0, u1 = 1.0 / (w0 * square), 1.0 / (w1 * square)
                for d in range(3):
                    s.f[d, k0] += u0 * t0[d]
                    s.f[d, k1] += u1 * t1[d]
                    s.f[d, k2] += u1 * t2[d]
                virials[c, 0] = u1 * (b0[0] * t1[0] + c0[0] * t2[0])
                virials[c, 1] = u1 * (b0[1] * t1[1] + c0[1] * t2[1])
                virials[c, 2] = u1 * (b0[2] * t1[2] + c0[2] * t2[2])
                virials[c, 3] = 0.5 * u1 * (b0[0] * t1[1] + c0[0] * t2[1] + b0[1] * t1[0] + c0[1] * t2[0])
                virials[c, 4] = 0.5 * u1 * (b0[0] * t1[2] + c0[0] * t2[2] + b0[2] * t1[0] + c0[2] * t2[0])
                virials[c, 5] = 0.5 * u1 * (b0[1] * t1[2] + c0[1] * t2[2] + b0[2] * t1[1] + c0[2] * t2[1])
            else:
                l3, r3 = 0.0, r1
                if kind == 3:
                    g, t = (held_dot(r1, r1), held_dot(r1, r2), held_dot(r2, r2)), (held_dot(s1, r1), held_dot(s1, r2), held_dot(s2, r1),
                                                                                    held_dot(s2, r2))
                    l1, l2, determinant = hold_two((w0 + w1, w0, w0 + w2), g, t, (e1, e2), tolerance, most)
                else:
                    if kind == 4:
                        r3 = (x0[0] - s.x[0, k3], x0[1] - s.x[1, k3], x0[2] - s.x[2, k3])
                        r3 = held_minus(r3, held_shift(r3, s.box.cell, straight))
                        v3 = w3 / mass_unit
                        s3 = (r3[0] + d0[0] - (step * s.v[0, k3] + ahead * v3 * s.f[0, k3]),
                              r3[1] + d0[1] - (step * s.v[1, k3] + ahead * v3 * s.f[1, k3]),
                              r3[2] + d0[2] - (step * s.v[2, k3] + ahead * v3 * s.f[2, k3]))
                    else:
                        r3, s3 = held_minus(r2, r1), held_minus(s2, s1)
                    e3 = lengths[c, 2] * lengths[c, 2] - held_dot(s3, s3)
                    l1, l2, l3, determinant = hold_three(held_masses(kind, w0, w1, w2, w3), r1, r2, r3, s1, s2, s3, (e1, e2, e3), tolerance,
                                                          most)
                if determinant == 0.0:
                    p[7] = c + 1.0
                l1, l2, l3 = l1 / square, l2 / square, l3 / square
                for d in range(3):
                    s.f[d, k0] += l1 * r1[d] + l2 * r2[d] + (l3 * r3[d] if kind == 4 else 0.0)
                    s.f[d, k1] -= l1 * r1[d] - (l3 * r3[d] if kind == 1 else 0.0)
                    s.f[d, k2] -= l2 * r2[d] + (l3 * r3[d] if kind == 1 else 0.0)
                    if kind == 4:
                        s.f[d, k3] -= l3 * r3[d]
                virials[c, 0] = l1 * r1[0] * r1[0] + l2 * r2[0] * r2[0] + l3 * r3[0] * r3[0]
                virials[c, 1] = l1 * r1[1] * r1[1] + l2 * r2[1] * r2[1] + l3 * r3[1] * r3[1]
                virials[c, 2] = l1 * r1[2] * r1[2] + l2 * r2[2] * r2[2] + l3 * r3[2] * r3[2]
                virials[c, 3] = l1 * r1[0] * r1[1] + l2 * r2[0] * r2[1] + l3 * r3[0] * r3[1]
                virials[c, 4] = l1 * r1[0] * r1[2] + l2 * r2[0] * r2[2] + l3 * r3[0] * r3[2]
                virials[c, 5] = l1 * r1[1] * r1[2] + l2 * r2[1] * r2[2] + l3 * r3[1] * r3[2]
    barrier(th)


def add_virials(th, s, p, a, weight):
    """This thread's clusters' part in the virial of the step, times `weight`."""
    if p[8] != 0.0:
        virials = a[3]
        m = virials.shape[0]
        for c in range(m * th.tid // th.nth, m * (th.tid + 1) // th.nth):
            for k in range(6):
                s.virial[th.tid, k] += weight * virials[c, k]


def hold_velocities(th, s, p, a, half):
    """Change v such that ``v + half f / m`` has no part along the distances."""
    barrier(th)
    atoms, kinds = a[0], a[1]
    mass_unit, straight = p[4], p[5] != 0.0
    m = kinds.shape[0]
    for c in range(m * th.tid // th.nth, m * (th.tid + 1) // th.nth):
        kind = kinds[c]
        k0, k1 = s.slot[atoms[c, 0]], s.slot[atoms[c, 1]]
        k2 = s.slot[atoms[c, 2]] if kind != 2 else k1
        k3 = s.slot[atoms[c, 3]] if kind == 4 else k1
        w0, w1, w2, w3 = s.inverse_mass[k0], s.inverse_mass[k1], s.inverse_mass[k2], s.inverse_mass[k3]
        x0 = (s.x[0, k0], s.x[1, k0], s.x[2, k0])
        v0 = (s.v[0, k0] + half * w0 * s.f[0, k0], s.v[1, k0] + half * w0 * s.f[1, k0], s.v[2, k0] + half * w0 * s.f[2, k0])
        v1 = (s.v[0, k1] + half * w1 * s.f[0, k1], s.v[1, k1] + half * w1 * s.f[1, k1], s.v[2, k1] + half * w1 * s.f[2, k1])
        r1 = (x0[0] - s.x[0, k1], x0[1] - s.x[1, k1], x0[2] - s.x[2, k1])
        r1 = held_minus(r1, held_shift(r1, s.box.cell, straight))
        u1 = -held_dot(held_minus(v0, v1), r1)
        m0, m1, m2, m3 = w0 * mass_unit, w1 * mass_unit, w2 * mass_unit, w3 * mass_unit
        if kind == 2:
            l1 = u1 / ((m0 + m1) * held_dot(r1, r1))
            for d in range(3):
                s.v[d, k0] += m0 * l1 * r1[d]
                s.v[d, k1] -= m1 * l1 * r1[d]
        else:
            v2 = (s.v[0, k2] + half * w2 * s.f[0, k2], s.v[1, k2] + half * w2 * s.f[1, k2], s.v[2, k2] + half * w2 * s.f[2, k2])
            r2 = (x0[0] - s.x[0, k2], x0[1] - s.x[1, k2], x0[2] - s.x[2, k2])
            r2 = held_minus(r2, held_shift(r2, s.box.cell, straight))
            u2 = -held_dot(held_minus(v0, v2), r2)
            l3, r3 = 0.0, r1
            if kind == 3:
                g, h, k = (m0 + m1) * held_dot(r1, r1), m0 * held_dot(r1, r2), (m0 + m2) * held_dot(r2, r2)
                determinant = g * k - h * h
                l1, l2 = (k * u1 - h * u2) / determinant, (g * u2 - h * u1) / determinant
            else:
                if kind == 4:
                    r3 = (x0[0] - s.x[0, k3], x0[1] - s.x[1, k3], x0[2] - s.x[2, k3])
                    r3 = held_minus(r3, held_shift(r3, s.box.cell, straight))
                    v3 = (s.v[0, k3] + half * w3 * s.f[0, k3], s.v[1, k3] + half * w3 * s.f[1, k3], s.v[2, k3] + half * w3 * s.f[2, k3])
                    u3 = -held_dot(held_minus(v0, v3), r3)
                else:
                    r3 = held_minus(r2, r1)
                    u3 = -held_dot(held_minus(v1, v2), r3)
                q = held_masses(kind, m0, m1, m2, m3)
                g12, g13, g23 = q[3] * held_dot(r1, r2), q[4] * held_dot(r1, r3), q[5] * held_dot(r2, r3)
                l1, l2, l3, determinant = hold_linear((q[0] * held_dot(r1, r1), g12, g13), (g12, q[1] * held_dot(r2, r2), g23),
                                                  (g13, g23, q[2] * held_dot(r3, r3)), (u1, u2, u3))
            if determinant == 0.0:
                p[7] = c + 1.0
            for d in range(3):
                s.v[d, k0] += m0 * (l1 * r1[d] + l2 * r2[d] + (l3 * r3[d] if kind == 4 else 0.0))
                s.v[d, k1] -= m1 * (l1 * r1[d] - (l3 * r3[d] if kind != 4 else 0.0))
                s.v[d, k2] -= m2 * (l2 * r2[d] + (l3 * r3[d] if kind != 4 else 0.0))
                if kind == 4:
                    s.v[d, k3] -= m3 * l3 * r3[d]
    barrier(th)


POSITIONS = (held_dot, held_minus, held_cross, held_shift, hold_one, hold_two, hold_three, hold_triangle, held_masses, hold_positions,
             add_virials)
VELOCITIES = (held_dot, held_minus, held_cross, held_shift, hold_linear, held_masses, hold_velocities)
