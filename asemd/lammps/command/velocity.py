"""``velocity group-ID style args keyword value ...``"""
from __future__ import annotations

import math

import numpy as np

from asemd import units
from asemd.errors import InputError, nearest
from asemd.fix.rigid import Rigid
from asemd.random import ParkMiller, gaussian_at, position_seeds, uniform_at
from asemd.words import choice, number, take, whole, yes_no

ARGUMENTS = {"create": 2, "set": 3, "scale": 1, "ramp": 6, "zero": 1}
AXES = ("x", "y", "z")
LOCAL_SKIP = 100    # draws thrown away by loop local


def run(session, args):
    scene = session.scene
    system = scene.need_system("velocity")
    scene.sync_groups()
    group, style = take(args, 2, "velocity")[:2]
    mask = scene.groups.mask(group, "velocity")
    if style not in ARGUMENTS:
        raise InputError(f"velocity: unknown style {style!r}{nearest(style, ARGUMENTS)}")
    words = take(args[2:], ARGUMENTS[style], f"velocity {style}")
    system.check_masses()
    job = Velocity(session, group, mask, style)
    job.options(args[2 + len(words):])
    getattr(job, style)(words)


class Velocity:
    """One velocity command on the atoms of `mask`."""

    def __init__(self, session, group: str, mask: np.ndarray, style: str):
        self.session, self.scene, self.system = session, session.scene, session.scene.system
        self.group, self.mask, self.what = group, mask, f"velocity {style}"
        self.rows = np.flatnonzero(mask)
        self.mass = self.system.atom_masses()
        self.dist, self.sum, self.mom, self.rot, self.loop, self.temp = "uniform", False, True, False, "all", None
        self.bias = False
        self.rigid = ""     # fix of rigid bodies whose bodies lose their momentum as a whole
        spacings = None if self.scene.lattice is None else self.scene.lattice.spacings
        self.spacings = np.ones(3) if spacings is None else spacings

    def options(self, words: list[str]) -> None:
        while words:
            key, what = words[0], f"{self.what} {words[0]}"
            value = take(words[1:], 1, what)[0]
            if key == "dist":
                self.dist = choice(value, ("uniform", "gaussian"), what)
            elif key in ("sum", "mom", "rot"):
                setattr(self, key, yes_no(value, what))
            elif key == "loop":
                self.loop = choice(value, ("all", "local", "geom"), what)
            elif key == "temp":
                if value not in self.scene.computes:
                    raise InputError(f"{what}: there is no compute {value}{nearest(value, self.scene.computes)}")
                self.temp = self.scene.computes[value]
                if not hasattr(self.temp, "dof"):
                    raise InputError(f"{what}: compute {value} (style {self.temp.style}) does not compute a temperature")
            elif key == "units":
                if choice(value, ("box", "lattice"), what) == "box":
                    self.spacings = np.ones(3)
            elif key == "bias":
                self.bias = yes_no(value, what)
            elif key == "rigid":
                if value not in self.scene.fixes:
                    raise InputError(f"{what}: there is no fix {value}{nearest(value, self.scene.fixes)}")
                self.rigid = value
            else:
                raise InputError(f"{self.what}: unknown keyword {key!r}"
                                 f"{nearest(key, ('dist', 'sum', 'mom', 'rot', 'loop', 'temp', 'units', 'bias', 'rigid'))}")
            words = words[2:]
        if self.bias and self.temp is None:
            raise InputError(f"{self.what} bias yes needs temp ID, a compute of a temperature with a bias")
        if self.bias and not self.temp.bias:
            raise InputError(f"{self.what} bias yes: compute {self.temp.id} (style {self.temp.style}) takes no bias off the velocities")

    # ---- styles
    def create(self, words: list[str]) -> None:
        target, seed = self._temperature(words[0]), whole(words[1], f"{self.what}: seed")
        if seed <= 0:
            raise InputError(f"{self.what}: the seed must be a positive whole number, got {seed}")
        v = self._draws(seed) * (1.0 / np.sqrt(self.mass[self.rows]))[:, None]
        if self.system.dimension == 2:
            v[:, 2] = 0.0
        old, flow = self.system.v.copy(), self._take_bias()
        self.system.v[self.rows] = v
        if self.mom:
            self._zero_momentum()
        if self.rot:
            self._zero_rotation()
        self._rescale(target, bare=self.bias)
        if flow is not None:
            mask = self.scene.groups.mask(self.temp.group)[:, None]
            self.system.v[:] = np.where(mask, self.temp.created(State(self.scene), flow), self.system.v)
        if self.sum:
            self.system.v[self.rows] += old[self.rows]

    def _draws(self, seed: int) -> np.ndarray:
        """Three numbers of mean zero for every atom of the group."""
        system, n = self.system, self.system.n
        gaussian = self.dist == "gaussian"
        if self.loop == "geom":
            states = position_seeds(seed, system.x[self.rows])
            return gaussian_at(states, 3) if gaussian else uniform_at(states, 3) - 0.5
        generator = ParkMiller(seed)
        if self.loop == "local":
            generator.skip(LOCAL_SKIP)
            count, place = len(self.rows), np.arange(len(self.rows))
        else:       # in order of id, all ids of the system
            if n and (system.id.min() != 1 or system.id.max() != n):
                raise InputError(f"{self.what}: loop all needs atom ids from 1 to {n} without gaps; use loop geom, or reset_atoms id")
            count, place = n, system.id[self.rows] - 1
        numbers = generator.gaussian(3 * count) if gaussian else generator.uniform(3 * count) - 0.5
        return numbers.reshape(-1, 3)[place]

    def set(self, words: list[str]) -> None:
        for k, word in enumerate(words):
            if word == "NULL":
                continue
            if word.startswith("v_"):
                new = self.session.variables.per_atom(word[2:], self.system.n)[self.rows]     # variables are not scaled
                bad = np.flatnonzero(~np.isfinite(new))
                if bad.size:
                    atom = self.system.id[self.rows[bad[0]]]
                    raise InputError(f"{self.what}: velocity is {new[bad[0]]:g} for atom {atom} (variable {word[2:]})")
            else:
                new = self._number(word) * self.spacings[k]
            if k == 2 and self.system.dimension == 2:
                if np.any(np.asarray(new) != 0.0):
                    raise InputError(f"{self.what}: the z velocity must be 0 or NULL in a 2d simulation")
                continue
            self.system.v[self.rows, k] = self.system.v[self.rows, k] + new if self.sum else new

    def scale(self, words: list[str]) -> None:
        target, flow = self._temperature(words[0]), self._take_bias()
        self._rescale(target)
        if flow is not None:
            self.system.v += flow

    def ramp(self, words: list[str]) -> None:
        v = ("vx", "vy", "vz").index(choice(words[0], ("vx", "vy", "vz"), self.what))
        c = AXES.index(choice(words[3], AXES, self.what))
        if v == 2 and self.system.dimension == 2:
            raise InputError(f"{self.what}: vz cannot be set in a 2d simulation")
        low, high = (self._number(w) * self.spacings[v] for w in words[1:3])
        first, last = (self._number(w) * self.spacings[c] for w in words[4:6])
        if first == last:
            raise InputError(f"{self.what}: the bounds must differ, got {words[4]} twice")
        fraction = np.clip((self.system.x[self.rows, c] - first) / (last - first), 0.0, 1.0)
        new = low + fraction * (high - low)
        self.system.v[self.rows, v] = self.system.v[self.rows, v] + new if self.sum else new

    def zero(self, words: list[str]) -> None:
        how = choice(words[0], ("linear", "angular"), self.what)
        if self.rigid:
            fix = self.scene.fixes[self.rigid]
            style = fix.style
            if isinstance(fix, Rigid):
                return fix.stop(self.system, rotation=how == "angular")
            raise InputError(f"{self.what} rigid: fix {self.rigid} (style {style}) has no rigid bodies")
        if how == "linear":
            self._zero_momentum()
        else:
            self._zero_rotation()

    # ---- parts
    def _number(self, word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = number(word, self.what)
        if not math.isfinite(value):
            raise InputError(f"{self.what}: velocity is {word}, which is not a finite number")
        return value

    def _temperature(self, word: str) -> float:
        target = self._number(word)
        if target < 0.0:
            raise InputError(f"{self.what}: the temperature must not be negative, got {word}")
        return target

    def _sum(self, values: np.ndarray) -> np.ndarray | float:
        """The sum over the group, one atom after the other: its last digits are part of the result."""
        return np.add.accumulate(values)[-1] if len(values) else np.zeros(values.shape[1:])

    def _zero_momentum(self) -> None:
        m = self.mass[self.rows]
        total = float(self._sum(m))
        if len(self.rows) == 0 or total == 0.0:
            raise InputError(f"{self.what}: cannot zero the momentum of no atoms (group {self.group})")
        self.system.v[self.rows] -= self._sum(self.system.v[self.rows] * m[:, None]) / total

    def _zero_rotation(self) -> None:
        if len(self.rows) == 0:
            raise InputError(f"{self.what}: cannot zero the rotation of no atoms (group {self.group})")
        m, system = self.mass[self.rows], self.system
        x = system.box.unwrap(system.x, system.image)[self.rows]
        d = x - self._sum(x * m[:, None]) / float(self._sum(m))
        (x, y, z), (vx, vy, vz) = d.T, system.v[self.rows].T
        momentum = self._sum(np.column_stack([m * (y * vz - z * vy), m * (z * vx - x * vz), m * (x * vy - y * vx)]))
        xx, yy, zz = self._sum(np.column_stack([m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y)]))
        xy, yz, xz = -self._sum(np.column_stack([m * x * y, m * y * z, m * x * z]))
        wx, wy, wz = _solve(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), momentum)
        system.v[self.rows] -= np.column_stack([wy * z - wz * y, wz * x - wx * z, wx * y - wy * x])

    def _take_bias(self) -> np.ndarray | None:
        """Take the bias off the velocities, and return it; None without ``bias yes``."""
        if not self.bias:
            return None
        mask, v = self.scene.groups.mask(self.temp.group), self.system.v
        flow = np.where(mask[:, None], v - self.temp.remove_bias(State(self.scene)), 0.0)
        v -= flow
        return flow

    def _current(self, bare: bool = False) -> float:
        """Temperature of the group: of the chosen compute, else 3 N - 3 degrees of freedom less those fixes remove."""
        system, u = self.system, units.get(self.system.units)
        if self.temp is not None and not bare:
            return float(self.temp.scalar(State(self.scene)))
        removed = sum(fix.removed_dof(self.mask) for fix in self.scene.fixes.values())
        dof = system.dimension * (len(self.rows) - 1) - removed
        if dof <= 0.0:
            return 0.0
        vx, vy, vz = system.v[self.rows].T
        return float(self._sum((vx * vx + vy * vy + vz * vz) * self.mass[self.rows])) * (u.mvv2e / (dof * u.boltz))

    def _rescale(self, target: float, bare: bool = False) -> None:
        now = self._current(bare)
        if now == 0.0:
            if target == 0.0:
                self.system.v[self.rows] = 0.0
                return
            raise InputError(f"{self.what}: the temperature of group {self.group} is 0 and cannot be scaled")
        self.system.v[self.rows] *= math.sqrt(target / now)


def _solve(inertia: np.ndarray, momentum: np.ndarray) -> np.ndarray:
    """Angular velocity; about axes without inertia (one atom, atoms in a line) it is zero."""
    (a, b, c), (_, e, f), (_, _, i) = inertia
    determinant = a * e * i + b * f * c + c * b * f - a * f * f - b * b * i - c * e * c
    if determinant <= 1e-6:
        return np.linalg.pinv(inertia, rcond=1e-7, hermitian=True) @ momentum
    inverse = np.array([[e * i - f * f, -(b * i - c * f), b * f - c * e],
                        [-(b * i - f * c), a * i - c * c, -(a * f - c * b)],
                        [b * f - e * c, -(a * f - b * c), a * e - b * b]]) / determinant
    return np.array([row[0] * momentum[0] + row[1] * momentum[1] + row[2] * momentum[2] for row in inverse])


class State:
    """What a temperature compute sees before a run."""

    def __init__(self, scene):
        self.system, self.groups, self.fixes = scene.system, scene.groups, list(scene.fixes.values())
        self.units, self.dimension, self.step, self.dt = units.get(scene.units), scene.dimension, scene.step, scene.dt
        self.gone: dict[str, int] = {}

    def mask(self, group: str) -> np.ndarray:
        return self.groups[group]
