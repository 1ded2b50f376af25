"""``displace_atoms group-ID style args keyword value``"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.quaternion import product
from asemd.random import position_seeds, uniform_at
from asemd.words import choice, number, take, whole

ARGUMENTS = {"move": 3, "ramp": 6, "random": 4, "rotate": 7}
AXES = ("x", "y", "z")


def run(session, args):
    scene = session.scene
    system = scene.need_system("displace_atoms")
    scene.sync_groups()
    group, style = take(args, 2, "displace_atoms")[:2]
    rows = np.flatnonzero(scene.groups.mask(group, "displace_atoms"))
    what = f"displace_atoms {style}"
    if style not in ARGUMENTS:
        raise InputError(f"displace_atoms: unknown style {style!r}{nearest(style, ARGUMENTS)}")
    words = take(args[2:], ARGUMENTS[style], what)
    spacings, options = np.ones(3) if scene.lattice is None else scene.lattice.spacings, args[2 + len(words):]
    if options:
        if options[0] != "units" or len(options) != 2:
            raise InputError(f"{what}: unknown keyword {options[0]!r}, there is units box|lattice")
        if choice(options[1], ("box", "lattice"), f"{what} units") == "box":
            spacings = np.ones(3)
    session.print("Displacing atoms ...")
    x, image = system.x.copy(), system.image.copy()
    if style == "move":
        for k in range(3):
            if words[k].startswith("v_"):
                system.x[:] = x         # a formula sees what the directions before it have done, as in LAMMPS
                x[rows, k] += session.variables.per_atom(words[k][2:], system.n)[rows] * spacings[k]
            else:
                x[rows, k] += number(words[k], what) * spacings[k]
    elif style == "ramp":
        _ramp(x, rows, words, spacings, what)
    elif style == "random":
        size = [number(w, what) * s for w, s in zip(words, spacings)]
        if system.dimension == 2 and size[2]:
            raise InputError(f"{what}: in a 2d simulation atoms must not move along z, got {words[2]}")
        u = uniform_at(position_seeds(whole(words[3], f"{what}: seed"), x[rows]), 3)
        for k in range(3):
            x[rows, k] += size[k] * 2.0 * (u[:, k] - 0.5)
    else:
        _rotate(system, x, image, rows, words, spacings, what)
    bad = np.flatnonzero(~np.isfinite(x).all(axis=1))
    if bad.size:
        raise InputError(f"{what}: atom {system.id[bad[0]]} would get a position that is not a number")
    system.box.wrap(x, image)
    system.x[:], system.image[:] = x, image
    system.box = system.box.shrink_wrapped(system.x)


def _ramp(x, rows, words, spacings, what) -> None:
    d, c = AXES.index(choice(words[0], AXES, what)), AXES.index(choice(words[3], AXES, what))
    low, high = (number(w, what) * spacings[d] for w in words[1:3])
    first, last = (number(w, what) * spacings[c] for w in words[4:6])
    if first == last:
        raise InputError(f"{what}: the bounds must differ, got {words[4]} twice")
    fraction = np.clip((x[rows, c] - first) / (last - first), 0.0, 1.0)
    x[rows, d] += low + fraction * (high - low)


def _rotate(system, x, image, rows, words, spacings, what) -> None:
    """Rotation about an axis through a point, of unwrapped positions; rounded as LAMMPS does, for random numbers that follow positions."""
    values = [number(w, what) for w in words]
    point, axis, angle = np.array(values[:3]) * spacings, np.array(values[3:6]), math.pi * values[6] / 180.0
    length = math.sqrt(axis @ axis)
    if length == 0.0:
        raise InputError(f"{what}: the axis must not be zero")
    if system.dimension == 2 and (axis[0] or axis[1]):
        raise InputError(f"{what}: in a 2d simulation the axis must be along z")
    axis /= length
    d = system.box.unwrap(x[rows], image[rows]) - point
    along = (d[:, 0] * axis[0] + d[:, 1] * axis[1] + d[:, 2] * axis[2])[:, None] * axis
    across = d - along
    x[rows] = point + along + (across * math.cos(angle) + np.cross(axis, across) * math.sin(angle))
    image[rows] = 0
    if "quaternions" in system.extra:
        turn = [math.cos(0.5 * angle), *(axis * math.sin(0.5 * angle))]
        system.extra["quaternions"][rows] = product(np.array(turn), system.extra["quaternions"][rows])
