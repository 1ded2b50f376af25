r"""Atoms move on a path of their own: forces do not count.

.. math:: \text{linear: } r = r_0 + V \delta, \quad \text{wiggle: } r = r_0 + A \sin(\omega \delta), \quad
          \text{rotate: about the axis R through P}, \quad \omega = 2 \pi / \text{period}

with the time :math:`\delta` since the fix was defined; ``transrot`` turns and drifts; ``variable`` takes displacements and velocities from
variables. A component NULL (None) of linear, wiggle and variable moves by its force, as in fix nve.

Source: LAMMPS manual, fix move. Units: velocity, distance, time. Spheres, ellipsoids and dipoles turn with rotate and transrot.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.fix.ellipsoids import principal
from asemd.fix.formula import read, write
from asemd.kernels.rigid import turn_axes
from asemd.words import choice, number, take

# kind -> names of its numbers
KINDS = {"linear": ("Vx", "Vy", "Vz"), "wiggle": ("Ax", "Ay", "Az", "period"), "rotate": ("Px", "Py", "Pz", "Rx", "Ry", "Rz", "period"),
         "transrot": ("Vx", "Vy", "Vz", "Px", "Py", "Pz", "Rx", "Ry", "Rz", "period"),
         "variable": ("v_dx", "v_dy", "v_dz", "v_vx", "v_vy", "v_vz")}
LENGTHS = ("Vx", "Vy", "Vz", "Ax", "Ay", "Az", "Px", "Py", "Pz")


def turn_ellipsoid(p, angle, mass, shape, first, q, momentum):
    """Angular momentum of a turn about the axis ``p[16:19]`` at the rate ``p[3]``, then the orientation after this angle."""
    e, moments, c, s = np.zeros((3, 3)), np.zeros(3), math.cos(0.5 * angle), math.sin(0.5 * angle)
    x, y, z = s * p[16], s * p[17], s * p[18]
    principal(mass, shape, moments)
    turn_axes(q, e)
    for d in range(3):
        momentum[d] = 0.0
    for k in range(3):
        w = moments[k] * p[3] * (p[16] * e[k, 0] + p[17] * e[k, 1] + p[18] * e[k, 2])
        for d in range(3):
            momentum[d] += w * e[k, d]
    q[0] = c * first[0] - x * first[1] - y * first[2] - z * first[3]
    q[1] = c * first[1] + x * first[0] + y * first[3] - z * first[2]
    q[2] = c * first[2] - x * first[3] + y * first[0] + z * first[1]
    q[3] = c * first[3] + x * first[2] - y * first[1] + z * first[0]


class Move(Fix):
    """Prescribed motion.

    Parameters
    ----------
    group : str
        The atoms it moves.
    kind : str
        ``linear``, ``wiggle``, ``rotate``, ``transrot`` or ``variable``.
    numbers : sequence of float or None or callable
        Velocities; amplitudes and a period; a point, an axis and a period; velocities and these; or functions of the loop for three
        displacements and three velocities. In units of the scene.

    Raises
    ------
    InputError
        An unknown kind, a wrong number of arguments, a period that is not positive, an axis of length 0.
    """

    style = "move"
    restarts = ("global", "peratom")
    integrates = True
    levels = "every"

    def __init__(self, group: str = "all", kind: str = "linear", numbers=(0.0, 0.0, 0.0)):
        super().__init__(group)
        if kind not in KINDS:
            raise InputError(f"fix move: expected one of {' '.join(KINDS)}, got {kind!r}{nearest(kind, KINDS)}")
        names = KINDS[kind]
        if len(numbers) != len(names):
            raise InputError(f"fix move {kind} needs {' '.join(names)}, got {len(numbers)} values")
        self.kind, self.given = kind, tuple(numbers)
        if names[-1] == "period" and not self.given[-1] > 0.0:
            raise InputError(f"fix move {kind}: the period must be positive, got {self.given[-1]:g}")
        if kind in ("rotate", "transrot") and not any(self.given[-4:-1]):
            raise InputError(f"fix move {kind}: Zero length rotation vector: the axis needs a direction")
        if kind == "variable":
            for k in range(3):
                if self.given[k] is not None and self.given[3 + k] is None:
                    raise InputError(f"fix move variable: {names[3 + k]} must not be NULL beside {names[k]}")
            if any(callable(v) for v in self.given):
                self.follows = "initial_integrate"
        self.places: np.ndarray | None = None
        self.turns: np.ndarray | None = None        # orientations of ellipsoids
        self.origin: int | None = None
        self.p, self.a, self.words = np.zeros(1), np.zeros((1, 1)), []

    @classmethod
    def from_lammps(cls, group, words, session):
        kind = take(words, 1, "fix move")[0]
        if kind not in KINDS:
            raise InputError(f"fix move: expected one of {' '.join(KINDS)}, got {kind!r}{nearest(kind, KINDS)}")
        what, names = f"fix move {kind}", KINDS[kind]
        given, rest, lattice = take(words[1:], len(names), what), words[1 + len(names):], True
        if rest:
            if rest[0] != "units" or len(rest) != 2:
                raise InputError(f"{what}: unknown words {' '.join(rest)}, there is units box or units lattice")
            lattice = choice(rest[1], ("box", "lattice"), f"{what} units") == "lattice"
        spacings = session.scene.lattice.spacings if lattice and session.scene.lattice is not None else np.ones(3)
        free, numbers = kind in ("linear", "wiggle", "variable"), []
        for word, name in zip(given, names):
            if word == "NULL" and free and name != "period":
                numbers.append(None)
            elif kind == "variable":
                value = read(word, f"{what} {name}", session)
                if not callable(value):
                    raise InputError(f"{what}: {name} must be a variable or NULL, got {word!r}")
                numbers.append(value)
            else:
                numbers.append(number(word, f"{what} {name}") * (float(spacings["xyz".index(name[1])]) if name in LENGTHS else 1.0))
        if session.scene.dimension == 2:
            cls.check_plane(kind, dict(zip(names, numbers)))
        fix = cls(group, kind, numbers)
        system = session.scene.system
        fix.places, fix.origin, fix.words = system.box.unwrap(system.x, system.image), session.scene.step, list(words)
        fix.turns = system.extra["quaternions"].copy() if "shape" in system.extra else None
        return fix

    @staticmethod
    def check_plane(kind: str, given: dict) -> None:
        """Two dimensions: nothing leaves the plane."""
        if any(given.get(name) for name in ("Vz", "Az", "Rx", "Ry")) or callable(given.get("v_dz")) or callable(given.get("v_vz")):
            raise InputError(f"Fix move cannot set {kind} motion out of the plane for 2d problem")

    def to_lammps(self) -> list[str]:
        return list(self.words) or [self.kind, *(write(v) for v in self.given), "units", "box"]

    # ---- numbers ------------------------------------------------------------------------------------------------------------------------
    def parameters(self, loop) -> np.ndarray:
        if self.origin is None:
            self.origin = loop.step
        kind = list(KINDS).index(self.kind)
        given = [0.0 if v is None or callable(v) else v for v in self.given]
        free = [float(v is None) for v in self.given[:3]] if self.kind in ("linear", "wiggle", "variable") else [0.0] * 3
        if self.kind == "variable":     # a velocity without a displacement is integrated
            free = [float(self.given[k] is None and self.given[3 + k] is None) for k in range(3)]
            drift = [float(self.given[k] is None and self.given[3 + k] is not None) for k in range(3)]
        else:
            drift = [0.0] * 3
        velocity = given[:3] if self.kind in ("linear", "wiggle", "transrot") else [0.0] * 3
        point = given[-7:-4] if kind in (2, 3) else [0.0] * 3
        axis = np.array(given[-4:-1]) if kind in (2, 3) else np.array([0.0, 0.0, 1.0])
        omega = 2.0 * math.pi / given[-1] if kind in (1, 2, 3) else 0.0
        self.p = np.array([loop.group_bit(self.group), kind, self.origin, omega, *free, *drift, *velocity, *point,
                           *(axis / math.sqrt(axis @ axis)), *(name in loop.system.extra for name in ("mu", "omega", "shape"))], float)
        return self.p

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        system = loop.system
        if self.places is None or len(self.places) != system.n:
            self.places = system.box.unwrap(system.x, system.image)
        self.a, nothing = np.zeros((system.n, 16)), np.zeros((1, 3))
        self.a[:, :3] = self.places
        mu = system.extra.get("mu", nothing)
        if len(mu) == system.n:
            self.a[:, 9:12] = mu        # turned step by step
        if "shape" in system.extra:
            if self.turns is None or len(self.turns) != system.n:
                self.turns = system.extra["quaternions"].copy()
            self.a[:, 12:] = self.turns
        others = (system.extra.get(name, nothing) for name in ("omega", "angmom", "shape"))
        return (self.a, mu, *others, system.extra.get("quaternions", np.zeros((1, 4))))

    def follow(self, loop) -> None:
        for k, value in enumerate(self.given):
            if callable(value):
                self.a[:, 3 + k] = value(loop)

    # ---- motion -------------------------------------------------------------------------------------------------------------------------
    @hook(uses=[principal, turn_axes, turn_ellipsoid])
    def initial_integrate(th, s, p, a):
        bit, kind, dt = np.int32(np.int64(p[0])), p[1], th.dt
        own, mu, spin, angmom, shape, quaternions = a
        delta = (th.step - p[2]) * dt
        angle = p[3] * delta
        sine, cosine = math.sin(angle), math.cos(angle)
        box = s.box.vectors
        rx, ry, rz = p[16], p[17], p[18]
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                if kind == 2.0 or kind == 3.0:
                    dx, dy, dz = own[row, 0] - p[13], own[row, 1] - p[14], own[row, 2] - p[15]
                    along = dx * rx + dy * ry + dz * rz
                    cx, cy, cz = along * rx, along * ry, along * rz
                    ax, ay, az = dx - cx, dy - cy, dz - cz
                    bx, by, bz = ry * az - rz * ay, rz * ax - rx * az, rx * ay - ry * ax
                    tx, ty, tz = cosine * ax + sine * bx, cosine * ay + sine * by, cosine * az + sine * bz
                    new = (p[13] + cx + tx, p[14] + cy + ty, p[15] + cz + tz)
                    speed = (p[3] * (ry * tz - rz * ty), p[3] * (rz * tx - rx * tz), p[3] * (rx * ty - ry * tx))
                    for d in range(3):
                        shift = s.image[row, 0] * box[0, d] + s.image[row, 1] * box[1, d] + s.image[row, 2] * box[2, d]
                        drift = p[10 + d] if kind == 3.0 else 0.0
                        s.x[d, i] = new[d] + drift * delta - shift
                        s.v[d, i] = speed[d] + drift
                    if p[20] != 0.0:
                        spin[row, 0], spin[row, 1], spin[row, 2] = p[3] * rx, p[3] * ry, p[3] * rz
                    if p[21] != 0.0 and shape[row, 0] > 0.0:
                        turn_ellipsoid(p, angle, s.mass[i], shape[row], own[row, 12:], quaternions[row], angmom[row])
                    continue
                for d in range(3):
                    shift = s.image[row, 0] * box[0, d] + s.image[row, 1] * box[1, d] + s.image[row, 2] * box[2, d]
                    if p[4 + d] != 0.0:
                        s.v[d, i] += 0.5 * dt * s.inverse_mass[i] * s.f[d, i]
                        s.x[d, i] += dt * s.v[d, i]
                    elif kind == 0.0:
                        s.v[d, i] = p[10 + d]
                        s.x[d, i] = own[row, d] + p[10 + d] * delta - shift
                    elif kind == 1.0:
                        s.v[d, i] = p[10 + d] * p[3] * cosine
                        s.x[d, i] = own[row, d] + p[10 + d] * sine - shift
                    elif p[7 + d] != 0.0:
                        s.v[d, i] = own[row, 6 + d]
                        s.x[d, i] += dt * s.v[d, i]
                    else:
                        s.v[d, i] = own[row, 6 + d]
                        s.x[d, i] = own[row, d] + own[row, 3 + d] - shift

    @hook
    def final_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for d in range(3):
            if p[4 + d] != 0.0:
                for i in range(th.lo, th.hi):
                    if s.mask[i] & bit != 0:
                        s.v[d, i] += 0.5 * th.dt * s.inverse_mass[i] * s.f[d, i]

    def state(self) -> dict:
        """Where the atoms were, and when."""
        turns = {} if self.turns is None else {"turns": self.turns}
        return {} if self.places is None else {"places": self.places, "origin": int(self.origin or 0), **turns}

    def restore(self, state: dict) -> None:
        if "places" in state:
            self.places, self.origin = np.array(state["places"]), int(state["origin"])
        if "turns" in state:
            self.turns = np.array(state["turns"])
