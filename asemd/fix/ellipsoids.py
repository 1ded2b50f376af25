r"""What integrators of ellipsoids share: kicks of the angular momenta by torques, and orientations that turn.

Functions have the names and arguments of those in `asemd.fix.spheres`, so that the hooks for spheres become hooks for ellipsoids
(`for_ellipsoids`). Angular momenta (n, 3), diameters (n, 3) and orientations (n, 4) stand by row; in `o` only 2 (ftm2v) and 3 to 6, what
counts in temperatures, are read.
"""
from __future__ import annotations

from functools import cache
from types import FunctionType

import numpy as np

from asemd.compute.temp import Temp
from asemd.compute.temp_asphere import TempAsphere
from asemd.errors import InputError
from asemd.fix import spheres
from asemd.kernels.rigid import angular_velocity, body_turned, turn_axes, turn_richardson
from asemd.kernels.threads import reduce_sum


def kick_spins(th, s, bit, factor, angmom, shape, o):
    """Angular momenta times a factor, then half a step of the torques."""
    push = 0.5 * th.dt * o[2]
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            for d in range(3):
                angmom[r, d] = angmom[r, d] * factor + push * s.torque[d, i]


def scale_spins(th, s, bit, factor, angmom):
    """Velocities and angular momenta times a factor."""
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            for d in range(3):
                s.v[d, i] *= factor
                angmom[r, d] *= factor


def principal(mass, shape, moments):
    """Moments of inertia of an ellipsoid with these diameters."""
    for k in range(3):
        b, c = shape[(k + 1) % 3], shape[(k + 2) % 3]
        moments[k] = 0.05 * mass * (b * b + c * c)


def turn_along(th, s, bit, angmom, shape, quaternions, o):
    """A step of the orientations at constant angular momentum."""
    e, moments, omega, whole, middle = np.zeros((3, 3)), np.zeros(3), np.zeros(3), np.zeros(4), np.zeros(4)
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r = s.row[i]
            q = quaternions[r]
            principal(s.mass[i], shape[r], moments)
            turn_axes(q, e)
            angular_velocity(angmom[r], e, moments, omega)
            turn_richardson(q, angmom[r], omega, moments, e, 0.5 * th.dt, whole, middle)


def spins_tensor(th, s, bit, terms, unit, angmom, shape, quaternions, moving, turning, out):
    """Sum of `moving` m v v and `turning` I w w along the axes of the bodies into ``out``: xx yy zz, and xy xz yz with six terms."""
    e, moments, w, total = np.zeros((3, 3)), np.zeros(3), np.zeros(3), np.zeros(6)
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            r, m = s.row[i], moving * s.mass[i]
            if turning != 0.0:
                principal(s.mass[i], shape[r], moments)
                turn_axes(quaternions[r], e)
                for k in range(3):
                    along = angmom[r, 0] * e[k, 0] + angmom[r, 1] * e[k, 1] + angmom[r, 2] * e[k, 2]
                    w[k] = along / moments[k] if moments[k] != 0.0 else 0.0
            for k in range(3):
                total[k] += m * s.v[k, i] * s.v[k, i] + turning * moments[k] * w[k] * w[k]
            total[3] += m * s.v[0, i] * s.v[1, i] + turning * moments[0] * w[0] * w[1]
            total[4] += m * s.v[0, i] * s.v[2, i] + turning * moments[1] * w[0] * w[2]
            total[5] += m * s.v[1, i] * s.v[2, i] + turning * moments[2] * w[1] * w[2]
    for k in range(terms):
        of_all = reduce_sum(th, total[k])
        if th.tid == 0:
            out[k] = unit * of_all


OWN = {f.__name__: f for f in (kick_spins, scale_spins, turn_along, spins_tensor)}
USES = (*OWN.values(), principal, turn_axes, angular_velocity, body_turned, turn_richardson)


@cache
def for_ellipsoids(function: FunctionType) -> FunctionType:
    """A function of the integrators of spheres with the functions of this module in place of those of `asemd.fix.spheres`."""
    if function.__module__ == spheres.__name__ and function.__name__ in OWN:
        return OWN[function.__name__]
    called = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    other = {name: for_ellipsoids(f) for name, f in called.items() if isinstance(f, FunctionType)}
    if all(f is called[name] for name, f in other.items()):
        return function
    out = FunctionType(function.__code__, function.__globals__ | other, function.__name__, function.__defaults__)
    out.__module__ = function.__module__
    vars(out).update(vars(function))
    if hasattr(function, "uses"):
        mine = [for_ellipsoids(f) for f in function.uses]
        out.uses = tuple(dict.fromkeys((*mine, *USES)))
    return out


def countable(temp) -> bool:
    """Whether compiled hooks can measure a temperature: that of all velocities of a group, with or without rotation."""
    return type(temp) is Temp or (type(temp) is TempAsphere and not temp.bias)


def check_shapes(fix, system, mask=None) -> None:
    """Whether atoms are ellipsoids.

    Raises
    ------
    InputError
        The atom style has none, or an atom of the mask is a point.
    """
    if "angmom" not in system.extra:
        raise InputError(f"fix {fix.style} needs ellipsoids: use atom_style ellipsoid, or hybrid with it")
    if mask is not None and (points := mask & (system.extra["shape"][:, 0] == 0.0)).any():
        raise InputError(f"fix {fix.style}: atom {system.id[points].min()} is a point, all atoms of the group need a shape")


def ellipsoid_arrays(fix, loop) -> tuple[np.ndarray, ...]:
    """Angular momenta, diameters, orientations, and the numbers `o`."""
    extra, temp, press = loop.system.extra, getattr(fix, "temp", None), getattr(fix, "press", None)
    own = press.temperature or temp if press is not None else temp
    counts = [float(c) for t in (temp, own) for c in (not getattr(t, "rotation_only", False), isinstance(t, TempAsphere))]
    return extra["angmom"], extra["shape"], extra["quaternions"], np.array([0.0, 0.0, loop.units.ftm2v, *counts])


class EllipsoidBath:
    """Goes before `asemd.fix.nvt.NVT`, `asemd.fix.npt.NPT` or `asemd.fix.nph.NPH` among the base classes of a fix."""

    turns = True

    @classmethod
    def from_lammps(cls, group, words, session):
        for word in words:
            if word in ("update", "disc"):
                raise InputError(f"fix {cls.style} {word} is for spheres, which fix {cls.style.replace('asphere', 'sphere')} moves")
        fix = super().from_lammps(group, words, session)
        check_shapes(fix, session.scene.need_system(f"fix {cls.style}"))
        return fix

    @property
    def all_plain(self) -> bool:
        press = getattr(self, "press", None)
        return countable(self.temp) and (press is None or countable(press.temperature or self.temp))

    def parameters(self, loop) -> np.ndarray:
        check_shapes(self, loop.system, loop.groups[self.group])
        return super().parameters(loop)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Of a barostat its own numbers first, then those of the ellipsoids."""
        self.turning = ellipsoid_arrays(self, loop)
        return (super().atom_arrays(loop) or ()) + self.turning

    def kick_turning(self, loop, bit: int) -> None:
        """Half a step of the torques, not compiled."""
        angmom, shape, _, o = self.turning
        kick_spins(loop._thread(), loop.state, bit, 1.0, angmom, shape, o)

    def turn(self, loop, bit: int) -> None:
        """A step of the orientations, not compiled."""
        turn_along(loop._thread(), loop.state, bit, *self.turning)
