"""``move`` and ``rotate``: a region that goes with variables.

Source: the LAMMPS manual page of ``region``: the region is turned about its axis first, then displaced. Displacements are distances, angles
radians.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from asemd.errors import InputError
from asemd.words import number


@dataclass
class Motion:
    """Names of the variables for the displacement and the angle, with the point and axis of the rotation."""

    value: Callable[[str], float]
    displacement: tuple[str | None, str | None, str | None] = (None, None, None)
    angle: str | None = None
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def scaled(self, spacings: np.ndarray) -> Motion:
        """With the point in distance units."""
        return replace(self, point=tuple(np.multiply(self.point, spacings)))

    def undo(self, x: np.ndarray) -> np.ndarray:
        """Where points of now were in the region as it was defined: (n, 3) -> (n, 3)."""
        x = x - [0.0 if name is None else self.value(name) for name in self.displacement]
        if self.angle is None:
            return x
        theta, point, axis = -self.value(self.angle), np.array(self.point), np.array(self.axis)
        axis /= np.sqrt(axis @ axis)
        d = x - point
        along = (d @ axis)[:, None] * axis
        across = d - along
        return point + along + np.cos(theta) * across + np.sin(theta) * np.cross(axis, d)

    def turn(self, d: np.ndarray) -> np.ndarray:
        """Directions in the region as it was defined -> those of now: (n, 3) -> (n, 3)."""
        if self.angle is None:
            return d
        theta, axis = self.value(self.angle), np.array(self.axis)
        axis /= np.sqrt(axis @ axis)
        along = (d @ axis)[:, None] * axis
        return along + np.cos(theta) * (d - along) + np.sin(theta) * np.cross(axis, d)


def move(motion: Motion, words: list[str], what: str) -> None:
    """``v_x v_y v_z``, each or NULL."""
    motion.displacement = tuple(None if w == "NULL" else _variable(motion, w, what) for w in words)


def rotate(motion: Motion, words: list[str], what: str) -> None:
    """``v_theta Px Py Pz Rx Ry Rz``."""
    motion.angle = _variable(motion, words[0], what)
    values = [number(w, what) for w in words[1:]]
    motion.point, motion.axis = tuple(values[:3]), tuple(values[3:])
    if not any(motion.axis):
        raise InputError(f"{what}: the axis must not be 0 0 0")


def _variable(motion: Motion, word: str, what: str) -> str:
    if not word.startswith("v_"):
        raise InputError(f"{what}: expected v_name, got {word!r}")
    motion.value(word[2:])      # which says what is wrong with it
    return word[2:]
