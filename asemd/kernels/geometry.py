"""Angles of vectors with their gradients, for styles of vectors; `Style.functions` hands them to the kernel.

No function divides by a sine that may vanish: where a direction is not defined (vectors on one line, a vector upright on its plane) its
gradient is zero.
"""
from __future__ import annotations

import math

from asemd.kernels.volume import low


def cross(ax, ay, az, bx, by, bz):
    """a x b with all its digits even if a and b are nearly on one line, so that it is upright on both."""
    p, q, r, s, t, u = ay * bz, az * by, az * bx, ax * bz, ax * by, ay * bx
    return ((p - q) + (low(p, ay, bz) - low(q, az, by)), (r - s) + (low(r, az, bx) - low(s, ax, bz)),
            (t - u) + (low(t, ax, by) - low(u, ay, bx)))


def angle_between(ax, ay, az, bx, by, bz):
    """Angle of two vectors, 0 to pi, and its derivatives by both (7 numbers)."""
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    n = math.sqrt(nx * nx + ny * ny + nz * nz)
    theta = math.atan2(n, ax * bx + ay * by + az * bz)
    if n == 0.0:
        return theta, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny, nz = nx / n, ny / n, nz / n
    aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
    return (theta, (ay * nz - az * ny) / aa, (az * nx - ax * nz) / aa, (ax * ny - ay * nx) / aa,
            (ny * bz - nz * by) / bb, (nz * bx - nx * bz) / bb, (nx * by - ny * bx) / bb)


def elevation(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Angle of c above the plane of a and b, -pi/2 to pi/2, positive on the side of a x b, and its derivatives by all (10 numbers).

    With n = a x b and q = n x c the angle is atan2(n . c, |q|). Source: Wilson, Decius and Cross, Molecular Vibrations (1955).
    """
    nx, ny, nz = cross(ax, ay, az, bx, by, bz)
    n = math.sqrt(nx * nx + ny * ny + nz * nz)
    if n == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny, nz = nx / n, ny / n, nz / n
    qx, qy, qz = ny * cz - nz * cy, nz * cx - nx * cz, nx * cy - ny * cx
    base, height = math.sqrt(qx * qx + qy * qy + qz * qz), nx * cx + ny * cy + nz * cz
    chi = math.atan2(height, base)
    if base == 0.0:
        return chi, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    qx, qy, qz = qx / base, qy / base, qz / base
    cc = cx * cx + cy * cy + cz * cz
    up, along = base / cc, height / cc                # q x n is the unit vector along the part of c in the plane
    ga, gb = -(bx * qx + by * qy + bz * qz) / n, (ax * qx + ay * qy + az * qz) / n
    return (chi, ga * nx, ga * ny, ga * nz, gb * nx, gb * ny, gb * nz, up * nx - along * (qy * nz - qz * ny),
            up * ny - along * (qz * nx - qx * nz), up * nz - along * (qx * ny - qy * nx))


def leans_over(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Whether c leans over to the side of a and b: the sum of its cosines with them is positive."""
    aa, bb = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz
    p, q = (ax * cx + ay * cy + az * cz) / math.sqrt(aa), (bx * cx + by * cy + bz * cz) / math.sqrt(bb)
    if p * q >= 0.0 or p * p + q * q < cx * cx + cy * cy + cz * cz:
        return p + q > 0.0
    ux, uy, uz = ay * cz - az * cy, az * cx - ax * cz, ax * cy - ay * cx       # all nearly on one line: the sines tell more
    vx, vy, vz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    s, t = (ux * ux + uy * uy + uz * uz) / aa, (vx * vx + vy * vy + vz * vz) / bb
    return s > t if q > 0.0 else s < t


def plane_distance(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Height of the origin over the plane through the ends of a, b and c, and its derivatives by all (10 numbers).

    Positive where the ends, seen from the origin, turn counter-clockwise.
    The derivatives are the weights of the ends at the foot of the height, times the normal of the plane.
    """
    ux, uy, uz, vx, vy, vz, wx, wy, wz = bx - ax, by - ay, bz - az, cx - bx, cy - by, cz - bz, ax - cx, ay - cy, az - cz
    uu, vv, ww = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    if uu >= vv and uu >= ww:                         # the two short edges have the most digits
        nx, ny, nz = cross(vx, vy, vz, wx, wy, wz)
    elif vv >= ww:
        nx, ny, nz = cross(wx, wy, wz, ux, uy, uz)
    else:
        nx, ny, nz = cross(ux, uy, uz, vx, vy, vz)
    n = math.sqrt(nx * nx + ny * ny + nz * nz)
    if n == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny, nz = nx / n, ny / n, nz / n
    wa = -((by * cz - bz * cy) * nx + (bz * cx - bx * cz) * ny + (bx * cy - by * cx) * nz) / n
    wb = -((cy * az - cz * ay) * nx + (cz * ax - cx * az) * ny + (cx * ay - cy * ax) * nz) / n
    wc = -((ay * bz - az * by) * nx + (az * bx - ax * bz) * ny + (ax * by - ay * bx) * nz) / n
    aa, bb, cc = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz
    if aa <= bb and aa <= cc:                         # from the nearest end: no digits cancel
        d = -(nx * ax + ny * ay + nz * az)
    elif bb <= cc:
        d = -(nx * bx + ny * by + nz * bz)
    else:
        d = -(nx * cx + ny * cy + nz * cz)
    return (d, wa * nx, wa * ny, wa * nz, wb * nx, wb * ny, wb * nz, wc * nx, wc * ny, wc * nz)
