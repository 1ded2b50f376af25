"""``change_box group-ID parameter args ... keyword value``"""
from __future__ import annotations

import math

import numpy as np

from asemd.box import Box
from asemd.errors import InputError, nearest
from asemd.lammps.command.create_box import describe
from asemd.words import choice, number, take

AXES = ("x", "y", "z")
TILTS = ("xy", "xz", "yz")
PARAMETERS = (*AXES, *TILTS, "boundary", "ortho", "triclinic", "set", "remap", "units")


def run(session, args):
    scene = session.scene
    system = scene.need_system("change_box")
    scene.sync_groups()
    group, *words = take(args, 2, "change_box") and args
    session.print("Changing box ...")
    mask = scene.groups.mask(group, "change_box")
    operations, lattice = _operations(words)
    spacings = scene.lattice.spacings if lattice and scene.lattice is not None else np.ones(3)
    x, image = system.x.copy(), system.image.copy()
    system.box.wrap(x, image)       # in the box as it was: atoms may have left it since the last list
    change = Change(session, system.box.shrink_wrapped(x), x[mask], spacings)
    for name, words in operations:
        change.apply(name, words)
    x[mask], box = change.x, change.box
    for k in np.flatnonzero(system.box.periodic & ~box.periodic):
        if image[:, k].any():
            session.warn(f"Resetting image flags for non-periodic dimension {AXES[k]}")
            image[:, k] = 0
    box.wrap(x, image)
    system.x[:], system.image[:] = x, image
    system.box = box.shrink_wrapped(x)
    scene.boundary = box.boundary
    session.stale()


def _operations(words: list[str]) -> tuple[list[tuple[str, list[str]]], bool]:
    """The operations in their order, each with its words, and whether lengths are in lattice spacings.

    What keeps the volume joins the operation that changes it: its words end in ``volume`` and directions.
    """
    out: list[tuple[str, list[str]]] = []
    lattice = True
    while words:
        key, what = words[0], f"change_box {words[0]}"
        if key not in PARAMETERS:
            raise InputError(f"change_box: unknown keyword {key!r}{nearest(key, PARAMETERS)}")
        if key == "units":
            lattice = choice(take(words[1:], 1, what)[0], ("lattice", "box"), what) == "lattice"
            words = words[2:]
            continue
        used = {"boundary": 3, "ortho": 0, "triclinic": 0, "set": 0, "remap": 0}.get(key)
        if used is None:
            styles = {"final": 2, "delta": 2, "scale": 1, "volume": 0} if key in AXES else {"final": 1, "delta": 1}
            style = choice(take(words[1:], 1, what)[0], styles, what)
            used = 1 + styles[style]
            if style == "volume":
                _join(out, key)
                words = words[2:]
                continue
        out.append((key, take(words[1:], used, what)))
        words = words[1 + used:]
    return out, lattice


def _join(operations: list[tuple[str, list[str]]], key: str) -> None:
    """``key volume`` belongs to the change of another direction before it."""
    if not operations or operations[-1][0] not in AXES or operations[-1][0] == key or operations[-1][1].count("volume") == 2:
        raise InputError(f"change_box {key} volume must follow the change of one other direction, with at most one more volume between")
    operations[-1][1].extend(("volume", key))


class Change:
    """Carries out the operations on a box and on positions."""

    def __init__(self, session, box: Box, x: np.ndarray, spacings: np.ndarray):
        self.session, self.scene = session, session.scene
        self.box, self.saved, self.x, self.spacings = box, box, x, spacings

    def apply(self, name: str, words: list[str]) -> None:
        box = self.box
        if name == "set":
            self.saved = box
        elif name == "remap":
            self.x = _to_box(_in_box(self.x, self.saved), box)
            self.saved = box
        elif name in AXES:
            self._length(name, words)
        elif name in TILTS:
            self._tilt(name, words)
        elif name == "boundary":
            boundary = Box(box.origin, box.cell, tuple(words)).boundary     # checks the letters
            if self.scene.dimension == 2 and boundary[2] != "pp":
                raise InputError("change_box boundary: in a 2d simulation z must be periodic")
            self._become(box.lo, box.hi, box.tilt, boundary, box.triclinic)
        else:
            self._shape(name)

    def _become(self, lo, hi, tilt, boundary, triclinic: bool) -> None:
        if not np.all(lo < hi):
            raise InputError(f"change_box: the box would have no volume, bounds ({' '.join(f'{v:g}' for v in lo)}) to "
                             f"({' '.join(f'{v:g}' for v in hi)})")
        self.box = Box.from_lammps(lo, hi, tilt, boundary, triclinic).widened()      # LAMMPS takes every step for a new box

    def _length(self, name: str, words: list[str]) -> None:
        box, k, what = self.box, AXES.index(name), f"change_box {name}"
        lo, hi = box.lo, box.hi
        d = self.scene.dimension
        if d == 2 and (name == "z" or "z" in words):
            raise InputError("change_box z: the z direction of a 2d simulation cannot be changed")
        volume = np.prod((hi - lo)[:d])
        if words[0] == "scale":
            _scale(lo, hi, k, number(words[1], what))
        else:
            values = [number(w, what) * self.spacings[k] for w in words[1:3]]
            lo[k], hi[k] = values if words[0] == "final" else (lo[k] + values[0], hi[k] + values[1])
        others = [AXES.index(w) for w in words if w in AXES]
        new = np.prod((hi - lo)[:d])
        if others and new > 0.0:
            for other in others:
                _scale(lo, hi, other, volume / new if len(others) == 1 else math.sqrt(volume / new))
        self._become(lo, hi, box.tilt, box.boundary, box.triclinic)
        self._tell()

    def _tilt(self, name: str, words: list[str]) -> None:
        box, k, what = self.box, TILTS.index(name), f"change_box {name}"
        if not box.triclinic:
            raise InputError(f"{what}: the box is orthogonal, use change_box triclinic before")
        if self.scene.dimension == 2 and name != "xy":
            raise InputError(f"{what}: a 2d box has no tilt {name}")
        value = number(words[1], what) * self.spacings[AXES.index(name[0])]
        tilt = box.tilt.copy()
        tilt[k] = value if words[0] == "final" else tilt[k] + value
        self._become(box.lo, box.hi, tilt, box.boundary, True)
        self._tell()

    def _shape(self, name: str) -> None:
        """``ortho`` and ``triclinic``."""
        box, scene = self.box, self.scene
        if scene.dumps:
            raise InputError(f"change_box {name} is not possible while there are dumps: use undump before and dump after it")
        if name == "ortho" and box.tilt.any():
            raise InputError("change_box ortho: the box is tilted, set xy, xz and yz to 0 before")
        self._become(box.lo, box.hi, box.tilt, box.boundary, name == "triclinic")
        self._tell()

    def _tell(self) -> None:
        self.session.print(f"  {describe(self.box)}")


def _scale(lo: np.ndarray, hi: np.ndarray, k: int, factor: float) -> None:
    """Stretch one direction about its middle."""
    middle = 0.5 * (lo[k] + hi[k])
    lo[k], hi[k] = middle + factor * (lo[k] - middle), middle + factor * (hi[k] - middle)


def _in_box(x: np.ndarray, box: Box) -> np.ndarray:
    """Fractional coordinates, always by inverse lengths as LAMMPS computes them here: they decide about atoms on a face."""
    return box.fractional(x) if box.triclinic else (x - box.lo) * (1.0 / (box.hi - box.lo))


def _to_box(s: np.ndarray, box: Box) -> np.ndarray:
    (lx, ly, lz), (xy, xz, yz), lo = box.hi - box.lo, box.tilt, box.lo
    return np.column_stack([lx * s[:, 0] + xy * s[:, 1] + xz * s[:, 2] + lo[0], ly * s[:, 1] + yz * s[:, 2] + lo[1], lz * s[:, 2] + lo[2]])
