"""Forces and torques between ellipsoids and spheres, for each pair of a list.

Constants of the generated module: ENERGY, PER_ATOM, FORM (the row of the coefficients that says what a pair of types is: 0 for two spheres,
whose energy is a function of the distance; others are for the style's function), SHAPED (more of a body matters than its first axis).
From the style: `plain(r2, rows, ti, tj)` -> energy, force/r; `potential(d, r2, form, ti, tj, rows, constants, first, second, work, out)`
-> energy; it writes the gradient by d = x_i - x_j and the derivatives by rotations of both, 9 numbers, to `out`; `work (4, 6)` is scratch.
A body is 0 G = A^T S^2 A and 1 B = A^T E A with the semi-axes S and relative well depths E of its type along the rows of A, 2 the row of
its type in `bodies`, that is the squared semi-axes, the E and the semi-axes, 3 A^T S A and from place 6 on the first row of A.
"""
from __future__ import annotations

import numpy as np

from asemd.kernels.pair_sums import add, eight, halve
from asemd.kernels.rigid import turn_axes

ENERGY = PER_ATOM = SHAPED = False
FORM = 0
plain = potential = None


def lay(e, sizes, k, out):
    """The tensor with these three values, from place `k` on, along the rows of `e`: xx yy zz xy xz yz."""
    a, b, c = sizes[k], sizes[k + 1], sizes[k + 2]
    out[0] = a * e[0, 0] * e[0, 0] + b * e[1, 0] * e[1, 0] + c * e[2, 0] * e[2, 0]
    out[1] = a * e[0, 1] * e[0, 1] + b * e[1, 1] * e[1, 1] + c * e[2, 1] * e[2, 1]
    out[2] = a * e[0, 2] * e[0, 2] + b * e[1, 2] * e[1, 2] + c * e[2, 2] * e[2, 2]
    out[3] = a * e[0, 0] * e[0, 1] + b * e[1, 0] * e[1, 1] + c * e[2, 0] * e[2, 1]
    out[4] = a * e[0, 0] * e[0, 2] + b * e[1, 0] * e[1, 2] + c * e[2, 0] * e[2, 2]
    out[5] = a * e[0, 1] * e[0, 2] + b * e[1, 1] * e[1, 2] + c * e[2, 1] * e[2, 2]


def stand(body, q, kind, bodies, e):
    """A body of that type with the orientation q; `e (3, 3)` is scratch."""
    if not SHAPED:
        a, b, c, d = q[0], q[1], q[2], q[3]
        body[3, 6], body[3, 7], body[3, 8] = a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)
    else:
        turn_axes(q, e)
        body[3, 6], body[3, 7], body[3, 8] = e[0, 0], e[0, 1], e[0, 2]
        for k in range(9):
            body[2, k] = bodies[kind, k]
        lay(e, body[2], 0, body[0])
        lay(e, body[2], 3, body[1])
        lay(e, body[2], 6, body[3])


def times(m, x, y, z):
    """A symmetric tensor times a vector."""
    return m[0] * x + m[3] * y + m[4] * z, m[3] * x + m[1] * y + m[5] * z, m[4] * x + m[5] * y + m[2] * z


def inverse(m, out):
    """The inverse of a symmetric tensor, and its determinant."""
    c0, c3, c4 = m[1] * m[2] - m[5] * m[5], m[4] * m[5] - m[3] * m[2], m[3] * m[5] - m[4] * m[1]
    det = m[0] * c0 + m[3] * c3 + m[4] * c4
    out[0], out[3], out[4] = c0 / det, c3 / det, c4 / det
    out[1], out[2], out[5] = (m[0] * m[2] - m[4] * m[4]) / det, (m[0] * m[1] - m[3] * m[3]) / det, (m[3] * m[4] - m[0] * m[5]) / det
    return det


def trace(m, n):
    """Of the product of two symmetric tensors."""
    return m[0] * n[0] + m[1] * n[1] + m[2] * n[2] + 2.0 * (m[3] * n[3] + m[4] * n[4] + m[5] * n[5])


def skew(m, n):
    """The antisymmetric part of the product of two symmetric tensors: its elements yz, zx and xy less their opposites."""
    return (m[3] * n[4] + m[1] * n[5] + m[5] * n[2] - m[4] * n[3] - m[5] * n[1] - m[2] * n[5],
            m[4] * n[0] + m[5] * n[3] + m[2] * n[4] - m[0] * n[4] - m[3] * n[5] - m[4] * n[2],
            m[0] * n[3] + m[3] * n[1] + m[4] * n[5] - m[3] * n[0] - m[1] * n[3] - m[5] * n[4])


def ellipsoid_forces(x, f, quaternions, row, torque, type_of, pair_i, pair_j, code, shifts, weight_lj, lo, hi, rows, constants, bodies,
                     acc, atom_energy, atom_virial, bad):
    """Pairs lo..hi-1: forces added to `f`, torques to `torque`, energy and virial to `acc (8,)`, shares to `atom_energy (cap,)` and
    `atom_virial (6, cap)`. `quaternions (n, 4)`: by row, `row (cap,)` the rows of the slots.

    `bad (4,)`: 1, the first pair whose energy is not finite, its distance.
    """
    e, out, d = np.zeros((3, 3)), np.zeros(9), np.zeros(3)
    first, second, work = np.zeros((4, 9)), np.zeros((4, 9)), np.zeros((4, 6))
    at = np.uint32(0xFFFFFFFF)
    for m in range(lo, hi):
        i = np.uint32(pair_i[np.uint64(m)])
        j = np.uint32(pair_j[np.uint64(m)])
        kind = np.uint32(code[np.uint64(m)] & 3)
        image = np.uint32(code[np.uint64(m)] >> 2)
        dx = x[0, i] - x[0, j] - shifts[image, 0]
        dy = x[1, i] - x[1, j] - shifts[image, 1]
        dz = x[2, i] - x[2, j] - shifts[image, 2]
        r2 = dx * dx + dy * dy + dz * dz
        ti = np.uint32(type_of[i])
        tj = np.uint32(type_of[j])
        weight = weight_lj[kind]
        if not r2 < rows[0, ti, tj] or weight == 0.0:
            continue
        form = rows[FORM, ti, tj]
        if form == 0.0:
            ev, fp = plain(r2, rows, ti, tj)
            gx, gy, gz = -fp * dx, -fp * dy, -fp * dz
        else:
            if i != at:      # pairs of one atom mostly follow each other
                at = i
                stand(first, quaternions[np.uint32(row[i])], ti, bodies, e)
            stand(second, quaternions[np.uint32(row[j])], tj, bodies, e)
            d[0], d[1], d[2] = dx, dy, dz
            ev = potential(d, r2, form, ti, tj, rows, constants, first, second, work, out)
            gx, gy, gz = out[0], out[1], out[2]
        if not abs(ev) < np.inf or not abs(gx) + abs(gy) + abs(gz) < np.inf:
            if bad[0] == 0.0:
                bad[0] = 1.0
                bad[1] = m
                bad[2] = np.sqrt(r2)
            continue
        ev, gx, gy, gz = weight * ev, -weight * gx, -weight * gy, -weight * gz
        f[0, i] += gx
        f[1, i] += gy
        f[2, i] += gz
        f[0, j] -= gx
        f[1, j] -= gy
        f[2, j] -= gz
        if form != 0.0:
            for k in range(3):
                torque[k, i] -= weight * out[3 + k]
                torque[k, j] -= weight * out[6 + k]
        if ENERGY:
            add(acc, eight(ev, 0.0, dx, dy, dz, gx, gy, gz))
        if PER_ATOM:
            halve(atom_energy, atom_virial, i, j, ev, dx, dy, dz, gx, gy, gz)
