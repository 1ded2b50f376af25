r"""Change the lengths and tilts of the box during a run, every N steps: strain, compression, shear.

.. math:: L(t) = L_0 (1 + R t) \;\text{(erate)}, \quad L_0 e^{R t} \;\text{(trate)}, \quad L_0 + A \sin \frac{2 \pi t}{T} \;\text{(wiggle)}

``final``, ``delta``, ``scale`` and ``vel`` go linearly to what they name at the end of the run, ``volume`` keeps the product of lengths,
``variable`` takes change and rate from two formulas. Lengths change about their middle (not ``final`` and ``delta``). Positions of the
group go with the box (``remap x``), or atoms that cross a periodic face get the velocity of the face on top (``remap v``), or neither.
With ``flip yes`` a tilt beyond half its length becomes the equivalent one of the other sign.

Source: LAMMPS manual, fix deform. Units: distance, velocity (vel), 1/time (rates), time (period).
"""
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.fix.deformation import LINEAR, TRUE, VARIABLE, VOLUME, WIGGLE, move, new_box, next_flip, remember, take_box, transform
from asemd.fix.formula import Formula
from asemd.kernels.box import follow
from asemd.kernels.threads import barrier
from asemd.words import choice, number, take, whole, yes_no

DIMENSIONS = ("x", "y", "z", "yz", "xz", "xy")
ENTRY = {"x": (0, 0), "y": (1, 1), "z": (2, 2), "yz": (2, 1), "xz": (2, 0), "xy": (1, 0)}
COUNTS = {"final": 2, "delta": 2, "scale": 1, "vel": 1, "erate": 1, "trate": 1, "volume": 0, "wiggle": 2, "variable": 2}
TILTS = {"final": 1, "delta": 1, "vel": 1, "erate": 1, "trate": 1, "wiggle": 2, "variable": 2}
KEYWORDS = ("remap", "flip", "units")
KIND = {"trate": TRUE, "volume": VOLUME, "wiggle": WIGGLE, "variable": VARIABLE}


class Change(NamedTuple):
    """How one length or tilt changes: style and values in box units, two functions of the loop for ``variable``."""

    how: str
    values: tuple = ()


class Deform(Fix):
    """Deform the box.

    Parameters
    ----------
    group : str
        The atoms that `remap` moves.
    every : int
        Steps between changes.
    changes : mapping
        ``x``, ``y``, ``z``, ``xy``, ``xz``, ``yz`` -> style and values, such as ``{"x": ("scale", 1.1), "y": ("volume",)}``; distances in
        box units. ``variable`` takes two functions of the loop, the change and its rate.
    remap : str
        ``x``, ``v`` or ``none``.
    flip : bool
        Replace tilts beyond half a length by equivalent ones.

    Raises
    ------
    InputError
        An unknown dimension or style, a wrong number of values, a volume without another dimension that changes.

    Examples
    --------
    >>> Deform(changes={"xy": ("erate", 0.001)}, remap="v")
    """

    style = "deform"
    levels = "every"

    def __init__(self, group: str = "all", every: int = 1, changes=None, remap: str = "x", flip: bool = True):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix deform: N must be at least 1, got {every}")
        self.every, self.remap, self.flip = every, choice(remap, ("x", "v", "none"), "fix deform remap"), flip
        self.changes: dict[str, Change] = {}
        for name, (style, *values) in (changes or {}).items():
            choice(name, DIMENSIONS, "fix deform")
            counts = TILTS if len(name) == 2 else COUNTS
            if len(values) != counts[choice(style, counts, f"fix deform {name}")]:
                raise InputError(f"fix deform {name} {style} needs {counts[style]} values, got {len(values)}")
            if style == "wiggle" and not values[1] > 0.0:
                raise InputError(f"fix deform {name} wiggle: the period must be positive, got {values[1]:g}")
            self.changes[name] = Change(style, tuple(values))
        self.kept = {d: self._keepers(d) for d, name in enumerate("xyz") if name in self.changes and self.changes[name].how == "volume"}
        self.box_moves = "shape" if any(len(name) == 2 for name in self.changes) else "size"
        self.initial: tuple[np.ndarray, np.ndarray] | None = None      # vectors and origin when it was defined
        self.p = np.zeros(34 + 13 * 6)
        self.image: np.ndarray | None = None
        self.planned: tuple = ()
        if any(change.how == "variable" for change in self.changes.values()):
            self.end_of_step = self.by_formulas

    def _keepers(self, d: int) -> tuple[int, int, int]:
        """How dimension `d` keeps the volume (1 one of one, 2 one of two, 3 two of one), and by which others."""
        styles = [self.changes[name].how if name in self.changes else "" for name in "xyz"]
        one, two = (d + 1) % 3, (d + 2) % 3
        if all(styles[k] in ("", "volume") for k in (one, two)):
            raise InputError("fix deform volume: another length must change by a style of its own")
        if "" in (styles[one], styles[two]):
            return (1, two, one) if styles[one] == "" else (1, one, two)
        if "volume" in (styles[one], styles[two]):
            return (3, two, one) if styles[one] == "volume" else (3, one, two)
        return 2, one, two

    @classmethod
    def from_lammps(cls, group, words, session):
        if not words:
            raise InputError("fix deform needs N and parameters such as x erate R")
        every, words = whole(words[0], "fix deform N"), words[1:]
        read: dict[str, list] = {}
        while words and words[0] in DIMENSIONS:
            name = words[0]
            style = choice(take(words[1:], 1, f"fix deform {name}")[0], TILTS if len(name) == 2 else COUNTS, f"fix deform {name}")
            values = take(words[2:], (TILTS if len(name) == 2 else COUNTS)[style], f"fix deform {name} {style}")
            read[name], words = [style, *values], words[2 + len(values):]
        options = {"remap": "x", "flip": "yes", "units": "lattice"}
        while words:
            if words[0] in DIMENSIONS:
                raise InputError(f"fix deform: {words[0]} must stand before {' '.join(KEYWORDS)}" if words[0] not in read
                                 else f"fix deform: {words[0]} is given twice")
            if words[0] not in KEYWORDS:
                raise InputError(f"fix deform: unknown keyword {words[0]!r}{nearest(words[0], (*KEYWORDS, *DIMENSIONS))}")
            options[words[0]] = take(words[1:], 1, f"fix deform {words[0]}")[0]
            words = words[2:]
        lattice = choice(options["units"], ("lattice", "box"), "fix deform units") == "lattice" and session.scene.lattice is not None
        spacings = session.scene.lattice.spacings if lattice else np.ones(3)
        changes = {}
        for name, (style, *values) in read.items():
            what, scale = f"fix deform {name} {style}", float(spacings["xyz".index(name[0])])
            if style == "variable":
                if any(not w.startswith("v_") for w in values):
                    raise InputError(f"{what}: needs two variables as v_name, got {' '.join(values)}")
                changes[name] = (style, *(Formula(w[2:], session) for w in values))
                continue
            numbers = [number(w, what) for w in values]
            if style in ("final", "delta", "vel"):
                numbers = [scale * n for n in numbers]
            elif style == "wiggle":
                numbers[0] *= scale
            changes[name] = (style, *numbers)
        new = cls(group, every, changes, options["remap"], yes_no(options["flip"], "fix deform flip"))
        new.check_box(session.scene.system.box)
        return new

    def check_box(self, box) -> None:
        """Whether the box can be deformed so; it is remembered as the start of ``run ... start``.

        Raises
        ------
        InputError
            A shrink-wrapped face that it would move, a tilt of a box that is not triclinic, a box that is not in LAMMPS's frame.
        """
        if not box.is_lammps_frame:
            raise InputError("fix deform: the box must have a along x and b in the xy plane")
        if any(len(name) == 2 for name in self.changes) and not box.triclinic:
            raise InputError("fix deform: tilts need a triclinic box: use change_box all triclinic")
        for name in self.changes:
            if set(box.boundary["xyz".index(name[-1])]) & set("sm"):
                raise InputError(f"fix deform {name}: direction {name[-1]} has a shrink-wrapped boundary")
        self.initial = box.cell.copy(), box.origin.copy()

    def to_lammps(self) -> list[str]:
        words = [str(self.every)]
        for name, (style, values) in self.changes.items():
            words += [name, style, *(str(v) if isinstance(v, Formula) else repr(float(v)) for v in values)]
        return [*words, "remap", self.remap, "flip", "yes" if self.flip else "no", "units", "box"]

    def hooks(self):
        """Lists matter where atoms cross faces or tilts flip."""
        found = super().hooks()
        if not (self.remap == "v" or self.flips):
            del found["pre_exchange"], found["post_neighbor"]
        return found

    @property
    def flips(self) -> bool:
        return self.flip and self.box_moves == "shape"

    @property
    def rates(self) -> tuple[np.ndarray, np.ndarray]:
        """Rates of the lengths and tilts as a matrix like that of the box vectors, and of its origin: the velocity of the box."""
        matrix = np.zeros((3, 3))
        for d, name in enumerate(DIMENSIONS):
            matrix[ENTRY[name]] = self.p[3 + d]
        return matrix, self.p[9:12].copy()

    # ---- a run ------------------------------------------------------------------------------------------------------------------------
    def prepare(self, loop) -> None:
        """The numbers of the run, before its first list."""
        box = loop.system.box
        if self.initial is None:        # made without a script: what was a box along the axes may tilt
            box.triclinic = box.triclinic or self.box_moves == "shape"
            self.check_box(box)
        if sum(isinstance(f, Deform) for f in loop.fixes) > 1:
            raise InputError("there is more than one fix deform: give one fix all the parameters")
        cell, origin = (box.cell, box.origin) if loop.step == loop.begin else self.initial
        p = self.p = np.zeros_like(self.p)
        p[0], p[1] = loop.group_bit(self.group), self.remap == "x"
        time = (loop.end - loop.begin) * loop.dt
        for d, name in enumerate(DIMENSIONS):
            change, row = self.changes.get(name), p[34 + 13 * d:47 + 13 * d]
            i, j = ENTRY[name]
            row[1:3] = (origin[i], origin[i] + cell[i, i]) if d < 3 else (cell[i, j], 0.0)
            row[3:5] = row[1:3]
            if change is None:
                continue
            row[0] = KIND.get(change.how, LINEAR)
            if d < 3:
                self._length(row, d, change, time, float(np.prod(np.diag(cell))))
            else:
                self._tilt(row, name, change, time, float(cell[i, i]))
            if row[0] == LINEAR and time != 0.0:
                p[3 + d] = ((row[4] - row[3]) - (row[2] - row[1]) if d < 3 else row[3] - row[1]) / time
                p[9 + d:10 + d] = (row[3] - row[1]) / time if d < 3 else p[9 + d:10 + d]
        self._check_yz(p)
        self.image = loop.system.image.copy()

    def _length(self, row, d: int, change: Change, time: float, volume: float) -> None:
        lo, hi = row[1:3]
        half, middle = 0.5 * (hi - lo), 0.5 * (lo + hi)
        value = (*change.values, 0.0)
        if change.how == "final":
            row[3:5] = value[:2]
        elif change.how == "delta":
            row[3:5] = lo + value[0], hi + value[1]
        elif change.how == "scale":
            row[3:5] = middle - value[0] * half, middle + value[0] * half
        elif change.how == "vel":
            row[3:5] = lo - 0.5 * time * value[0], hi + 0.5 * time * value[0]
        elif change.how == "erate":
            row[3:5] = lo - time * value[0] * half, hi + time * value[0] * half
        elif change.how == "trate":
            row[5] = value[0]
        elif change.how == "wiggle":
            row[5:7] = value[:2]
            if not abs(value[0]) < hi - lo:
                raise InputError(f"fix deform {'xyz'[d]} wiggle: the amplitude {value[0]:g} is not below the length {hi - lo:g} of the box")
        elif change.how == "volume":
            row[7:11] = volume, *self.kept[d]
        if not row[3] < row[4]:
            raise InputError(f"fix deform {'xyz'[d]} {change.how}: the box would have length {row[4] - row[3]:g} at the end of the run")

    def _tilt(self, row, name: str, change: Change, time: float, across: float) -> None:
        start, value = row[1], (*change.values, 0.0)
        if change.how == "final":
            row[3] = value[0]
        elif change.how == "delta":
            row[3] = start + value[0]
        elif change.how == "vel":
            row[3] = start + time * value[0]
        elif change.how == "erate":
            row[3] = start + time * value[0] * across
        elif change.how == "trate":
            if start == 0.0:
                raise InputError(f"fix deform {name} trate: the tilt is zero and stays so; use erate")
            row[5], row[3] = value[0], start * math.exp(value[0] * time)
        elif change.how == "wiggle":
            row[5:7], row[3] = value[:2], start + value[0]
            row[2] = start - value[0]

    def _check_yz(self, p) -> None:
        """A flip of yz changes xz by xy, which must not change, too."""
        if not (self.flips and "yz" in self.changes and "xy" in self.changes):
            return
        if self.changes["yz"].how == "variable":
            raise InputError("fix deform: yz by variables cannot change together with xy unless flip is no")
        row, y = p[34 + 39:34 + 52], p[34 + 13:34 + 26]
        ends = (row[1], row[3], row[2]) if self.changes["yz"].how == "wiggle" else (row[1], row[3])
        if max(abs(t) / min(y[2] - y[1], y[4] - y[3]) for t in ends) > 0.5:
            raise InputError("fix deform: yz changes by more than half the length of y together with xy; use flip no")

    def parameters(self, loop) -> np.ndarray:
        self._cross(loop)
        self._plan(loop)
        return self.p

    def _plan(self, loop) -> None:
        """When a tilt is to be flipped next."""
        box = loop.state.box
        left = self.next_reneighbor == loop.step + 1 and (np.abs(self._ratios(box)) > 0.5).any()        # by the run before
        self.planned, self.next_reneighbor = (loop.begin, loop.end, loop.dt), loop.step + 1 if left else -1
        if self.flips and not left and "end_of_step" not in self.__dict__:
            at = next_flip(loop.step, self.every, loop.end, loop.begin, loop.end, loop.dt, self.p.copy(), box.vectors.copy(),
                           box.origin.copy(), box.periodic != 0.0)
            self.next_reneighbor = at + 1 if at > 0 else -1

    @hook(uses=[new_box, remember, take_box, transform, follow])
    def end_of_step(th, s, p, a):
        barrier(th)
        if th.tid == 0:
            new_box(th.step, th.begin, th.end, th.dt, p, s.box.vectors, s.box.origin)
            remember(p, s.box.vectors, s.box.origin)
        barrier(th)
        if p[1] != 0.0:
            transform(s, p, th.lo, th.hi)
        if th.tid == 0:
            take_box(p, s.box.vectors, s.box.origin)
            follow(s.box)
        barrier(th)

    def by_formulas(self, loop) -> None:
        """`end_of_step` with formulas."""
        p, box = self.p, loop.state.box
        for d, name in enumerate(DIMENSIONS):
            change = self.changes.get(name)
            if change is not None and change.how == "variable":
                p[34 + 13 * d + 11:34 + 13 * d + 13] = [_single(f(loop), name) for f in change.values]
        new_box(loop.step, loop.begin, loop.end, loop.dt, p, box.vectors, box.origin)
        self.adjust(loop)
        remember(p, box.vectors, box.origin)
        if self.remap == "x":
            move(loop.state, p, loop.nslots)
        take_box(p, box.vectors, box.origin)
        follow(box)
        if self.flips and (np.abs(self._ratios(box)) > 0.5).any():
            self.next_reneighbor = loop.step + 1

    def adjust(self, loop) -> None:
        """Change the faces that were found, ``p[12:18]``; for fixes built on this one."""

    @staticmethod
    def _ratios(box) -> np.ndarray:
        """yz xz xy over the length they are parallel to; 0 where that direction is not periodic."""
        v, periodic = box.vectors, box.periodic
        return np.array([v[2, 1] / v[1, 1] * periodic[1], v[2, 0] / v[0, 0] * periodic[0], v[1, 0] / v[0, 0] * periodic[0]])

    # ---- lists ------------------------------------------------------------------------------------------------------------------------
    def pre_exchange(self, loop) -> None:
        """Flip the box if that is due."""
        flipped = loop.step == self.next_reneighbor
        if flipped:
            self._flip(loop)
        if flipped or self.planned != (loop.begin, loop.end, loop.dt):
            self._plan(loop)
        self.image = None if flipped else loop.system.image.copy()      # atoms put back by a flip keep their velocity, as in LAMMPS

    def _flip(self, loop) -> None:
        box, limit = loop.state.box, 0.5 - 1e-12
        vectors, turn = box.vectors.copy(), np.eye(3, dtype=np.int64)
        for row, column in ((2, 1), (2, 0), (1, 0)):
            ratio = vectors[row, column] / vectors[column, column]
            if box.periodic[column] and abs(ratio) > limit:
                sign = -1 if ratio > 0.0 else 1
                vectors[row] += sign * vectors[column]
                turn[row] += sign * turn[column]
        loop.system.image[:] = np.rint(loop.system.image @ np.linalg.inv(turn))
        box.vectors[:] = vectors
        follow(box)

    def post_neighbor(self, loop) -> None:
        self._cross(loop)

    def _cross(self, loop) -> None:
        """Atoms that were put back through a periodic face get the velocity of that face."""
        if self.remap != "v" or self.image is None:
            return
        crossed = loop.system.image - self.image
        rows = np.flatnonzero(crossed.any(axis=1) & loop.groups[self.group])
        if len(rows):
            slots = loop.state.slot[rows]
            loop.state.v[:, slots] -= (crossed[rows] @ self.rates[0]).T
            loop.system.v[rows] = loop.state.v[:, slots].T

    def state(self) -> dict:
        """The box when the fix was defined, for ``run ... start``."""
        return {} if self.initial is None else {"vectors": self.initial[0], "origin": self.initial[1]}

    def restore(self, state: dict) -> None:
        self.initial = np.array(state["vectors"], float).reshape(3, 3), np.array(state["origin"], float)


def _single(value, name: str) -> float:
    if np.ndim(value):
        raise InputError(f"fix deform {name} variable: needs equal-style variables")
    return float(value)
