"""Friction and noise on the rotation of spheres and ellipsoids, for `asemd.fix.langevin`."""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.fix.ellipsoids import check_shapes, principal
from asemd.kernels.random import uniform
from asemd.kernels.rigid import angular_velocity, turn_axes


def push_spheres(th, s, p, a, omega, radius):
    """Friction and noise on the rotation of spheres."""
    bit, seed, step = np.int32(np.int64(p[0])), np.int64(p[1]), th.step
    done = 0.0
    if th.end != th.begin:
        done = (step - th.begin) / (th.end - th.begin)
    root = math.sqrt(p[5] + done * (p[6] - p[5]))
    friction, noise = (10.0 / 3.0) * p[7], math.sqrt((10.0 / 3.0) * p[8] / th.dt)
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            inertia = 0.4 * s.mass[i] * radius[r] * radius[r]
            ratio, size = p[16 + s.type[i]], a[r, 3] if p[4] != 0.0 else root
            for d in range(3):
                kick = noise * math.sqrt(inertia / ratio) * size * (uniform(seed, step, r, 3 + d) - 0.5)
                s.torque[d, i] += kick - friction * inertia / ratio * omega[r, d]


def push_ellipsoids(th, s, p, a, angmom, shape, quaternions, factor):
    """Friction and noise on the rotation of ellipsoids, times a factor."""
    bit, seed, step = np.int32(np.int64(p[0])), np.int64(p[1]), th.step
    done = 0.0
    if th.end != th.begin:
        done = (step - th.begin) / (th.end - th.begin)
    root = math.sqrt(p[5] + done * (p[6] - p[5]))
    friction, noise = factor * p[7], math.sqrt(factor * p[8] / th.dt)
    e, moments, omega = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            principal(s.mass[i], shape[r], moments)
            turn_axes(quaternions[r], e)
            angular_velocity(angmom[r], e, moments, omega)
            ratio, size = p[16 + s.type[i]], a[r, 3] if p[4] != 0.0 else root
            for d in range(3):
                kick = noise * math.sqrt(moments[d] / ratio) * size * (uniform(seed, step, r, 6 + d) - 0.5)
                s.torque[d, i] += kick - friction * moments[d] / ratio * omega[d]


def check_turning(fix, loop) -> None:
    """Whether all atoms of the group are what ``omega`` and ``angmom`` ask for.

    Raises
    ------
    InputError
    """
    system, mask = loop.system, loop.groups[fix.group]
    if fix.angmom:
        check_shapes(fix, system, mask)
    if not fix.omega:
        return
    if "omega" not in system.extra:
        raise InputError("fix langevin omega yes needs atoms with a radius: use atom_style sphere, or hybrid with it")
    points = mask & ~(system.extra["radius"] > 0.0)
    if points.any():
        raise InputError(f"fix langevin omega yes: atom {system.id[points].min()} is a point, all atoms of the group need a radius")


def spins(fix, extra) -> tuple[np.ndarray, ...]:
    """Angular velocities, radii; angular momenta, diameters, orientations; whether spheres and by which factor ellipsoids are pushed."""
    nothing = np.zeros((1, 3))
    return (extra.get("omega", nothing), extra.get("radius", np.zeros(1)), extra.get("angmom", nothing), extra.get("shape", nothing),
            extra.get("quaternions", np.zeros((1, 4))), np.array([float(fix.omega), fix.angmom]))
