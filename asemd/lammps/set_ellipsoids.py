"""Shapes and orientations of ellipsoids by the command set."""
from __future__ import annotations

import math

import numpy as np

from asemd.atom_style import UPRIGHT
from asemd.errors import InputError
from asemd.quaternion import unit
from asemd.random import position_seeds, uniform_at
from asemd.words import whole


def set_ellipsoids(setter, key: str, values: list[str]) -> int:
    """``shape``, ``quat`` or ``quat/random`` of the atoms that a `asemd.lammps.command.set.Setter` has selected; how many there are.

    Raises
    ------
    InputError
        Atoms without shape or orientation, a shape or axis that cannot be.
    """
    extra, rows, system = setter.system.extra, setter.rows, setter.system
    if "shape" not in extra:
        raise InputError(f"{setter.what}: atom_style {system.atom_style} has no ellipsoids")
    if key == "shape":
        shape = np.column_stack([setter._values(word) for word in values])
        if (shape < 0.0).any() or ((shape == 0.0).any(axis=1) & (shape != 0.0).any(axis=1)).any():
            raise InputError(f"{setter.what}: the three diameters must be positive, or all 0 for points, got {' '.join(values)}")
        new = (extra["shape"][rows, 0] == 0.0) | (shape[:, 0] == 0.0)
        extra["quaternions"][rows[new]] = UPRIGHT
        extra["shape"][rows] = shape
        return len(rows)
    points = extra["shape"][rows, 0] == 0.0
    if points.any():
        raise InputError(f"{setter.what}: atom {system.id[rows[points][0]]} is a point without orientation, set its shape first")
    flat = system.dimension == 2
    if key == "quat":
        axis = np.column_stack([setter._values(word) for word in values[:3]])
        half = 0.5 * np.radians(setter._values(values[3]))
        if flat and axis[:, :2].any():
            raise InputError(f"{setter.what}: in two dimensions the axis must be along z, got {' '.join(values[:3])}")
        if (~axis.any(axis=1) & (np.sin(half) != 0.0)).any():
            raise InputError(f"{setter.what}: the axis must not be zero")
        # as in LAMMPS an axis that is no unit vector makes another angle
        extra["quaternions"][rows] = unit(np.column_stack([np.cos(half), axis * np.sin(half)[:, None]]))
        return len(rows)
    seed = whole(values[0], f"{setter.what}: seed")
    if seed <= 0:
        raise InputError(f"{setter.what}: the seed must be positive, got {values[0]}")
    u = uniform_at(position_seeds(seed, system.x[rows]), 1 if flat else 3)
    if flat:
        half, zero = math.pi * u[:, 0], np.zeros(len(rows))
        q = np.column_stack([np.cos(half), zero, zero, np.sin(half)])
    else:
        a, b = np.sqrt(1.0 - u[:, 0]), np.sqrt(u[:, 0])
        first, second = 2.0 * math.pi * u[:, 1], 2.0 * math.pi * u[:, 2]
        q = np.column_stack([np.cos(second) * b, np.sin(first) * a, np.cos(first) * a, np.sin(second) * b])
    extra["quaternions"][rows] = unit(q)
    return len(rows)
