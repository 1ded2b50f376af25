r"""What integrators of spheres share in compiled code: kicks of the angular velocities by torques, and dipoles that turn along.

Functions of the same names and arguments are in `asemd.fix.ellipsoids` for other bodies. `o` has 0 the moment of inertia per mass and
radius squared, 1 how dipoles turn (`NONE`, `PLAIN`, `DLM`), 2 ftm2v, then for a thermostat whether 3 translation and 4 rotation count in
its temperature, 5 and 6 the same for the temperature of the pressure. Angular velocities `omega`, dipoles `mu` (n, 3) and radii (n,)
stand by row.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.compute.erotate_sphere import INERTIA
from asemd.compute.temp_sphere import TempSphere
from asemd.errors import InputError, nearest
from asemd.kernels.threads import reduce_sum

NONE, PLAIN, DLM = 0.0, 1.0, 2.0
UPDATES = {"dipole": PLAIN, "dipole/dlm": DLM}
DISC = 0.5      # the moment of inertia of a disc, per mass and radius squared


def turn(q, w, axis, angle):
    """Rotate the angular velocity `w` and the frame `q`, rows in the body, about one of the body's axes (small-angle form of the angle)."""
    square = 0.25 * angle * angle
    c, s = (1.0 - square) / (1.0 + square), angle / (1.0 + square)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    wj, wk = w[j], w[k]
    w[j], w[k] = c * wj - s * wk, s * wj + c * wk
    for d in range(3):
        qj, qk = q[j, d], q[k, d]
        q[j, d], q[k, d] = c * qj + s * qk, -s * qj + c * qk


def kick_spins(th, s, bit, factor, omega, radius, o):
    """Angular velocities times a factor, then half a step of the torques."""
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            push = 0.5 * th.dt * o[2] / (o[0] * s.mass[i] * radius[r] * radius[r])
            for d in range(3):
                omega[r, d] = omega[r, d] * factor + push * s.torque[d, i]


def move_spheres(th, s, bit):
    """The positions."""
    mine = slice(th.lo, th.hi)
    mask = s.mask[mine]
    for d in range(3):
        x, v = s.x[d, mine], s.v[d, mine]
        for i in range(x.size):
            if mask[i] & bit != 0:
                x[i] += th.dt * v[i]


def scale_spins(th, s, bit, factor, omega):
    """Velocities and angular velocities times a factor."""
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            for d in range(3):
                s.v[d, i] *= factor
                omega[r, d] *= factor


def turn_along(th, s, bit, omega, radius, mu, o):
    """A step of the dipoles with their spheres."""
    if o[1] == 0.0:
        return
    half, q, w = 0.5 * th.dt, np.zeros((3, 3)), np.zeros(3)
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit == 0:
            continue
        r = s.row[i]
        length = math.sqrt(mu[r, 0] ** 2 + mu[r, 1] ** 2 + mu[r, 2] ** 2)
        if length == 0.0:
            continue
        if o[1] == 1.0:
            x = mu[r, 0] + th.dt * (omega[r, 1] * mu[r, 2] - omega[r, 2] * mu[r, 1])
            y = mu[r, 1] + th.dt * (omega[r, 2] * mu[r, 0] - omega[r, 0] * mu[r, 2])
            z = mu[r, 2] + th.dt * (omega[r, 0] * mu[r, 1] - omega[r, 1] * mu[r, 0])
            scale = length / math.sqrt(x * x + y * y + z * z)
            mu[r, 0], mu[r, 1], mu[r, 2] = x * scale, y * scale, z * scale
            continue
        # rows of q are the axes of a body whose z axis is the dipole
        a0, a1, a2 = mu[r, 0] / length, mu[r, 1] / length, mu[r, 2] / length
        across = a0 * a0 + a1 * a1
        if across != 0.0:
            c = (1.0 - a2) / across
            q[0, 0], q[0, 1], q[0, 2] = 1.0 - c * a0 * a0, -c * a0 * a1, -a0
            q[1, 0], q[1, 1], q[1, 2] = -c * a0 * a1, 1.0 - c * a1 * a1, -a1
            q[2, 0], q[2, 1], q[2, 2] = a0, a1, 1.0 - c * across
        else:
            q[:] = 0.0
            q[0, 0], q[1, 1], q[2, 2] = 1.0 / a2, 1.0, a2
        for d in range(3):
            w[d] = q[d, 0] * omega[r, 0] + q[d, 1] * omega[r, 1] + q[d, 2] * omega[r, 2]
        turn(q, w, 0, half * w[0])
        turn(q, w, 1, half * w[1])
        turn(q, w, 2, th.dt * w[2])
        turn(q, w, 1, half * w[1])
        turn(q, w, 0, half * w[0])
        for d in range(3):
            omega[r, d] = q[0, d] * w[0] + q[1, d] * w[1] + q[2, d] * w[2]
            mu[r, d] = length * q[2, d]


def spins_tensor(th, s, bit, terms, unit, omega, radius, mu, moving, turning, out):
    """Sum of `moving` m v v and `turning` I w w over a group into ``out``: xx yy zz, and xy xz yz with six terms."""
    for k in range(terms):
        first, second = k, k
        if k > 2:
            first, second = (0, 1) if k == 3 else (0, 2) if k == 4 else (1, 2)
        total = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                r = s.row[i]
                spin = 0.4 * radius[r] * radius[r] * omega[r, first] * omega[r, second]
                total += s.mass[i] * (moving * s.v[first, i] * s.v[second, i] + turning * spin)
        total = reduce_sum(th, total)
        if th.tid == 0:
            out[k] = unit * total


TURNS = [turn, turn_along, kick_spins]


def check_spheres(fix, system) -> None:
    """Whether atoms have what an integrator of spheres needs.

    Raises
    ------
    InputError
    """
    what = f"fix {fix.style}"
    if "radius" not in system.extra:
        raise InputError(f"{what} needs atoms with a radius: use atom_style sphere, or hybrid with it")
    if fix.dipole and fix.dipole not in UPDATES:
        raise InputError(f"{what}: unknown update {fix.dipole!r}{nearest(fix.dipole, UPDATES)}")
    if fix.dipole and "mu" not in system.extra:
        raise InputError(f"{what} update {fix.dipole} needs atoms with dipoles: use atom_style hybrid sphere dipole")
    if fix.disc and system.dimension != 2:
        raise InputError(f"{what} disc is for two dimensions")


def check_radii(fix, loop) -> None:
    """At the start of a run.

    Raises
    ------
    InputError
        An atom of the group is a point.
    """
    system = loop.system
    check_spheres(fix, system)
    points = loop.groups[fix.group] & ~(system.extra["radius"] > 0.0)
    if points.any():
        raise InputError(f"fix {fix.style}: atom {system.id[points].min()} is a point, all atoms need a radius; fix nve moves points")


def sphere_arrays(fix, loop) -> tuple[np.ndarray, ...]:
    """Angular velocities, radii, dipoles, and the numbers `o`."""
    extra = loop.system.extra
    temp = getattr(fix, "temp", None)
    press = getattr(fix, "press", None)
    own = press.temperature or temp if press is not None else temp
    counts = [float(c) for t in (temp, own) for c in (not getattr(t, "rotation_only", False), isinstance(t, TempSphere))]
    numbers = np.array([DISC if fix.disc else INERTIA, UPDATES.get(fix.dipole, NONE), loop.units.ftm2v, *counts])
    return extra["omega"], extra["radius"], extra.get("mu", np.zeros((1, 3))), numbers
