r"""Rigid bodies in compiled loops: forces and torques on bodies, rotations, and the atoms put back in their places.

A body has the position x and velocity v of its centre of mass, an orientation (the unit quaternion q, whose principal axes are the rows of
`axes`), an angular momentum, and principal moments of inertia. Each thread has a share of the bodies and moves all their atoms.
"""
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Bodies(NamedTuple):
    """The bodies of a fix; atoms of body k are the places ``first[k]`` to ``first[k + 1] - 1`` of `rows`, `place`, `virial`."""

    mass: np.ndarray          # (nb,)
    x: np.ndarray             # (nb, 3) centre of mass, wrapped into the box at list builds
    v: np.ndarray             # (nb, 3)
    force: np.ndarray         # (nb, 3) on the centre of mass
    torque: np.ndarray        # (nb, 3) about it
    momentum: np.ndarray      # (nb, 3) angular momentum about it
    omega: np.ndarray         # (nb, 3) angular velocity
    moments: np.ndarray       # (nb, 3) principal moments of inertia
    axes: np.ndarray          # (nb, 3, 3) rows: principal axes
    q: np.ndarray             # (nb, 4) orientation
    p: np.ndarray             # (nb, 4) momentum conjugate to q, of the symplectic integrators
    image: np.ndarray         # (nb, 3) float: periods of the box to add to x
    moves: np.ndarray         # (nb, 6) 1 or 0: components of force and torque that act
    bath: np.ndarray          # (nb, 6) force and torque of a Langevin bath
    half_virial: np.ndarray   # (nb, 6) of the first half of the step
    box: np.ndarray           # (nb, 12) origin and vectors of the box in which x is
    first: np.ndarray         # (nb + 1,) int64
    rows: np.ndarray          # (m,) int64 atom rows
    place: np.ndarray         # (m, 3) positions of the atoms along the axes of their body
    virial: np.ndarray        # (m, 6) of the constraint, xx yy zz xy xz yz
    radius: np.ndarray        # (m,) of spheres, which bring torques of their own and turn with their body; 0 for points
    dipole: np.ndarray        # (m, 3) dipoles along the axes of their body; (0, 3) if there are none
    spin: np.ndarray          # (n, 3) angular velocities of all atoms by row; not read where there are no spheres
    mu: np.ndarray            # (n, 3) dipoles of all atoms by row; the same
    solid: np.ndarray         # (m, 7) of ellipsoids: moments of inertia about their own axes, orientation as seen from the body; else 0
    momenta: np.ndarray       # (n, 3) angular momenta of all atoms by row; not read where there are no ellipsoids
    turned: np.ndarray        # (n, 4) orientations of all atoms by row; the same


def turn_axes(q, e):
    """Principal axes (rows of `e`) of the orientation q."""
    a, b, c, d = q[0], q[1], q[2], q[3]
    e[0, 0], e[0, 1], e[0, 2] = a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)
    e[1, 0], e[1, 1], e[1, 2] = 2.0 * (b * c - a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d + a * b)
    e[2, 0], e[2, 1], e[2, 2] = 2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a - b * b - c * c + d * d


def angular_velocity(momentum, e, moments, omega):
    """From the angular momentum in space; nothing turns about an axis without inertia."""
    omega[0] = omega[1] = omega[2] = 0.0
    for k in range(3):
        if moments[k] != 0.0:
            w = (momentum[0] * e[k, 0] + momentum[1] * e[k, 1] + momentum[2] * e[k, 2]) / moments[k]
            for d in range(3):
                omega[d] += w * e[k, d]


def body_turned(q, w, h, out):
    """``q + h w q``, normalised: a step of dq/dt = w q / 2 with the angular velocity w in space."""
    a = q[0] - h * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3])
    b = q[1] + h * (w[0] * q[0] + w[1] * q[3] - w[2] * q[2])
    c = q[2] + h * (w[1] * q[0] + w[2] * q[1] - w[0] * q[3])
    d = q[3] + h * (w[2] * q[0] + w[0] * q[2] - w[1] * q[1])
    scale = 1.0 / math.sqrt(a * a + b * b + c * c + d * d)
    out[0], out[1], out[2], out[3] = a * scale, b * scale, c * scale, d * scale


def turn_richardson(q, momentum, omega, moments, e, half, whole, middle):
    """One timestep of the orientation at constant angular momentum: a whole step and two half steps, extrapolated.

    `half` is half the timestep; the angular velocity is left as it is in the middle of the step. `whole` and `middle` (4,) are scratch.
    """
    body_turned(q, omega, half, whole)
    body_turned(q, omega, 0.5 * half, middle)
    turn_axes(middle, e)
    angular_velocity(momentum, e, moments, omega)
    body_turned(middle, omega, 0.5 * half, middle)
    square = 0.0
    for k in range(4):
        q[k] = 2.0 * middle[k] - whole[k]
        square += q[k] * q[k]
    scale = 1.0 / math.sqrt(square)
    for k in range(4):
        q[k] *= scale
    turn_axes(q, e)


def turn_about(axis, p, q, moments, dt):
    """Free rotation about one principal axis, exact: a factor of the symplectic splitting."""
    if axis == 0:
        a, b, c, d = -q[1], q[0], q[3], -q[2]
        e, f, g, h = -p[1], p[0], p[3], -p[2]
    elif axis == 1:
        a, b, c, d = -q[2], -q[3], q[0], q[1]
        e, f, g, h = -p[2], -p[3], p[0], p[1]
    else:
        a, b, c, d = -q[3], q[2], -q[1], q[0]
        e, f, g, h = -p[3], p[2], -p[1], p[0]
    rate = 0.0
    if moments[axis] != 0.0:
        rate = (p[0] * a + p[1] * b + p[2] * c + p[3] * d) / (4.0 * moments[axis])
    x, y = math.cos(dt * rate), math.sin(dt * rate)
    p[0], p[1], p[2], p[3] = x * p[0] + y * e, x * p[1] + y * f, x * p[2] + y * g, x * p[3] + y * h
    q[0], q[1], q[2], q[3] = x * q[0] + y * a, x * q[1] + y * b, x * q[2] + y * c, x * q[3] + y * d


def turn_symplectic(p, q, moments, dt):
    """One timestep of free rotation (no_squish): about the axes 3 2 1 2 3, for halves of the step but for axis 1."""
    turn_about(2, p, q, moments, 0.5 * dt)
    turn_about(1, p, q, moments, 0.5 * dt)
    turn_about(0, p, q, moments, dt)
    turn_about(1, p, q, moments, 0.5 * dt)
    turn_about(2, p, q, moments, 0.5 * dt)


def kick_conjugate(p, q, e, torque, h):
    """Add ``h`` times the torque (in space) to the momentum conjugate to q."""
    x = e[0, 0] * torque[0] + e[0, 1] * torque[1] + e[0, 2] * torque[2]
    y = e[1, 0] * torque[0] + e[1, 1] * torque[1] + e[1, 2] * torque[2]
    z = e[2, 0] * torque[0] + e[2, 1] * torque[1] + e[2, 2] * torque[2]
    p[0] -= h * (q[1] * x + q[2] * y + q[3] * z)
    p[1] += h * (q[0] * x + q[2] * z - q[3] * y)
    p[2] += h * (q[0] * y + q[3] * x - q[1] * z)
    p[3] += h * (q[0] * z + q[1] * y - q[2] * x)


def momentum_of(p, q, e, momentum):
    """The angular momentum in space from the one conjugate to q."""
    x = 0.5 * (-q[1] * p[0] + q[0] * p[1] + q[3] * p[2] - q[2] * p[3])
    y = 0.5 * (-q[2] * p[0] - q[3] * p[1] + q[0] * p[2] + q[1] * p[3])
    z = 0.5 * (-q[3] * p[0] + q[2] * p[1] - q[1] * p[2] + q[0] * p[3])
    for d in range(3):
        momentum[d] = e[0, d] * x + e[1, d] * y + e[2, d] * z


def follow_box(s, b, k):
    """The centre of mass of body k keeps its place relative to a box that has changed."""
    old, h = b.box[k], s.box.vectors
    same = True
    for d in range(3):
        same = same and old[d] == s.box.origin[d]
        for c in range(3):
            same = same and old[3 + 3 * c + d] == h[c, d]
    if same:
        return
    r = b.x[k]
    x, y, z = r[0] - old[0], r[1] - old[1], r[2] - old[2]
    # fractional coordinates in the old box: ratios of triple products
    ax, ay, az, bx, by, bz, cx, cy, cz = old[3], old[4], old[5], old[6], old[7], old[8], old[9], old[10], old[11]
    volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    u = (x * (by * cz - bz * cy) + y * (bz * cx - bx * cz) + z * (bx * cy - by * cx)) / volume
    v = (x * (cy * az - cz * ay) + y * (cz * ax - cx * az) + z * (cx * ay - cy * ax)) / volume
    w = (x * (ay * bz - az * by) + y * (az * bx - ax * bz) + z * (ax * by - ay * bx)) / volume
    for d in range(3):
        r[d] = s.box.origin[d] + u * h[0, d] + v * h[1, d] + w * h[2, d]
        old[d] = s.box.origin[d]
        for c in range(3):
            old[3 + 3 * c + d] = h[c, d]


def gather_forces(s, p, b, k, outside):
    """Force and torque on body k, with `outside` (1 or 0) times those of its bath and of the field ``p[13:16]``."""
    h = s.box.vectors
    cx, cy, cz = b.x[k, 0], b.x[k, 1], b.x[k, 2]
    fx = fy = fz = tx = ty = tz = 0.0
    for j in range(b.first[k], b.first[k + 1]):
        r = b.rows[j]
        i = s.slot[r]
        m0, m1, m2 = s.image[r, 0] - b.image[k, 0], s.image[r, 1] - b.image[k, 1], s.image[r, 2] - b.image[k, 2]
        dx = s.x[0, i] + m0 * h[0, 0] + m1 * h[1, 0] + m2 * h[2, 0] - cx
        dy = s.x[1, i] + m0 * h[0, 1] + m1 * h[1, 1] + m2 * h[2, 1] - cy
        dz = s.x[2, i] + m0 * h[0, 2] + m1 * h[1, 2] + m2 * h[2, 2] - cz
        gx, gy, gz = s.f[0, i], s.f[1, i], s.f[2, i]
        fx += gx
        fy += gy
        fz += gz
        tx += dy * gz - dz * gy
        ty += dz * gx - dx * gz
        tz += dx * gy - dy * gx
        if b.radius[j] > 0.0 or b.solid[j, 0] > 0.0:
            tx += s.torque[0, i]
            ty += s.torque[1, i]
            tz += s.torque[2, i]
    b.force[k, 0], b.force[k, 1], b.force[k, 2] = fx, fy, fz
    b.torque[k, 0], b.torque[k, 1], b.torque[k, 2] = tx, ty, tz
    if outside != 0.0:
        for d in range(3):
            b.force[k, d] = b.force[k, d] + b.bath[k, d] + b.mass[k] * p[13 + d]
            b.torque[k, d] += b.bath[k, 3 + d]


def kick_body(p, b, k, half, slow):
    """Half a step of force and torque; before it velocity and momentum are multiplied by `slow (4,)`, the latter if they are conjugate
    to q (``p[0]`` is 1)."""
    for d in range(3):
        b.v[k, d] = b.v[k, d] * slow[d] + half / b.mass[k] * b.force[k, d] * b.moves[k, d]
    if p[0] == 0.0:
        for d in range(3):
            b.momentum[k, d] += half * b.torque[k, d] * b.moves[k, 3 + d]
    else:
        for d in range(3):
            b.torque[k, d] *= b.moves[k, 3 + d]
        for d in range(4):
            b.p[k, d] *= slow[3]
        kick_conjugate(b.p[k], b.q[k], b.axes[k], b.torque[k], 2.0 * half)
        momentum_of(b.p[k], b.q[k], b.axes[k], b.momentum[k])
    angular_velocity(b.momentum[k], b.axes[k], b.moments[k], b.omega[k])


def kick_level(th, s, p, b, outside, share, slow):
    """Half a step of all bodies by the forces of one of several levels; `share` of the virial of the constraint is kept for the step."""
    sums, count = np.empty(6), b.mass.shape[0]
    for k in range(count * th.tid // th.nth, count * (th.tid + 1) // th.nth):
        if p[2] != 0.0:
            follow_box(s, b, k)
        gather_forces(s, p, b, k, outside)
        kick_body(p, b, k, 0.5 * th.dt * p[10], slow)
        place_atoms(s, b, k, 0.5 * th.dt * p[1], share, False, sums)
        for c in range(6):
            b.half_virial[k, c] += sums[c]


def turn_solid(b, k, j, r, moving):
    """Orientation, if `moving`, and angular momentum of an ellipsoid of body k."""
    q, o, out = b.q[k], b.solid[j, 3:], b.turned[r]
    if moving:
        out[0] = q[0] * o[0] - q[1] * o[1] - q[2] * o[2] - q[3] * o[3]
        out[1] = q[0] * o[1] + q[1] * o[0] + q[2] * o[3] - q[3] * o[2]
        out[2] = q[0] * o[2] - q[1] * o[3] + q[2] * o[0] + q[3] * o[1]
        out[3] = q[0] * o[3] + q[1] * o[2] - q[2] * o[1] + q[3] * o[0]
        scale = 1.0 / math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3])
        for c in range(4):
            out[c] *= scale
    e = np.empty((3, 3))
    turn_axes(out, e)
    for c in range(3):
        b.momenta[r, c] = 0.0
    for axis in range(3):
        w = b.solid[j, axis] * (e[axis, 0] * b.omega[k, 0] + e[axis, 1] * b.omega[k, 1] + e[axis, 2] * b.omega[k, 2])
        for c in range(3):
            b.momenta[r, c] += w * e[axis, c]


def place_atoms(s, b, k, half, share, moving, sums):
    """Atoms of body k where the body has them (if `moving`), with its velocities; `sums (6,)` gets `share` of the virial of the constraint
    whose forces act for the time `half`."""
    h, e = s.box.vectors, b.axes[k]
    wx, wy, wz = b.omega[k, 0], b.omega[k, 1], b.omega[k, 2]
    for c in range(6):
        sums[c] = 0.0
    for j in range(b.first[k], b.first[k + 1]):
        r = b.rows[j]
        i = s.slot[r]
        m0, m1, m2 = s.image[r, 0] - b.image[k, 0], s.image[r, 1] - b.image[k, 1], s.image[r, 2] - b.image[k, 2]
        ox = m0 * h[0, 0] + m1 * h[1, 0] + m2 * h[2, 0]
        oy = m0 * h[0, 1] + m1 * h[1, 1] + m2 * h[2, 1]
        oz = m0 * h[0, 2] + m1 * h[1, 2] + m2 * h[2, 2]
        x, y, z = share * (s.x[0, i] + ox), share * (s.x[1, i] + oy), share * (s.x[2, i] + oz)
        dx = e[0, 0] * b.place[j, 0] + e[1, 0] * b.place[j, 1] + e[2, 0] * b.place[j, 2]
        dy = e[0, 1] * b.place[j, 0] + e[1, 1] * b.place[j, 1] + e[2, 1] * b.place[j, 2]
        dz = e[0, 2] * b.place[j, 0] + e[1, 2] * b.place[j, 1] + e[2, 2] * b.place[j, 2]
        vx = wy * dz - wz * dy + b.v[k, 0]
        vy = wz * dx - wx * dz + b.v[k, 1]
        vz = wx * dy - wy * dx + b.v[k, 2]
        if half != 0.0:
            m = 1.0 / (half * s.inverse_mass[i])
            gx, gy, gz = m * (vx - s.v[0, i]) - s.f[0, i], m * (vy - s.v[1, i]) - s.f[1, i], m * (vz - s.v[2, i]) - s.f[2, i]
            w = b.virial[j]
            if moving:
                for c in range(6):
                    w[c] = 0.0
            w[0] += x * gx
            w[1] += y * gy
            w[2] += z * gz
            w[3] += x * gy
            w[4] += x * gz
            w[5] += y * gz
            sums[0] += x * gx
            sums[1] += y * gy
            sums[2] += z * gz
            sums[3] += x * gy
            sums[4] += x * gz
            sums[5] += y * gz
        s.v[0, i], s.v[1, i], s.v[2, i] = vx, vy, vz
        if b.radius[j] > 0.0:
            b.spin[r, 0], b.spin[r, 1], b.spin[r, 2] = wx, wy, wz
        if b.solid[j, 0] > 0.0:
            turn_solid(b, k, j, r, moving)
        if moving and b.dipole.shape[0] > 0:
            for c in range(3):
                b.mu[r, c] = e[0, c] * b.dipole[j, 0] + e[1, c] * b.dipole[j, 1] + e[2, c] * b.dipole[j, 2]
        if moving:
            s.x[0, i], s.x[1, i], s.x[2, i] = dx + b.x[k, 0] - ox, dy + b.x[k, 1] - oy, dz + b.x[k, 2] - oz


def place_moved(th, s, p, b, k):
    """`place_atoms` of a body that has moved: barostats now see the virial of this half of the step in place of that of the last step."""
    sums, seen = np.empty(6), p[1] != 0.0 and p[2] != 0.0 and p[3] < 2.0
    for j in range(b.first[k], b.first[k + 1] if seen else b.first[k]):
        for c in range(6):
            s.virial[th.tid, c] -= b.virial[j, c]
    place_atoms(s, b, k, 0.5 * th.dt * p[1], 0.5, True, sums)
    for c in range(6):
        b.half_virial[k, c] = sums[c]
        if seen:
            s.virial[th.tid, c] += sums[c]


def langevin_bath(th, p, b, k):
    """Friction and noise on body k; ``p[5]`` is the seed (0: none), ``p[6]`` to ``p[9]`` temperatures, friction and noise."""
    if p[5] == 0.0:
        return
    done = 0.0
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    noise, seed = math.sqrt(p[9] / th.dt * (p[6] + done * (p[7] - p[6]))), np.int64(p[5])
    for d in range(3):
        b.bath[k, d] = -p[8] * b.mass[k] * b.v[k, d] + math.sqrt(b.mass[k]) * noise * (uniform(seed, th.step, k, d) - 0.5)
        b.bath[k, 3 + d] = 0.0
    for axis in range(3):
        e, moment = b.axes[k, axis], b.moments[k, axis]
        w = b.omega[k, 0] * e[0] + b.omega[k, 1] * e[1] + b.omega[k, 2] * e[2]
        turn = -p[8] * moment * w + math.sqrt(moment) * noise * (uniform(seed, th.step, k, 3 + axis) - 0.5)
        for d in range(3):
            b.bath[k, 3 + d] += turn * e[d]
    if p[11] == 2.0:
        b.bath[k, 2] = b.bath[k, 3] = b.bath[k, 4] = 0.0
