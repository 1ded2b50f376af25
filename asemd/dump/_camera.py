"""Where a picture is taken from: words ``view``, ``center``, ``up``, ``zoom``; each number may be a variable."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asemd.errors import InputError
from asemd.words import number, take

FILL = 0.92     # part of the picture that the box takes up
CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)


@dataclass
class Camera:
    """Parallel projection of a box.

    Attributes
    ----------
    view : tuple of str
        theta and phi, degrees: angle from +z and around z; numbers or ``v_name``.
    centre : tuple of str
        Point of the box in the middle of the picture, fractions of its edges.
    dynamic : bool
        Whether `centre` follows a box that changes.
    up : tuple of str
    zoom : str
    """

    view: tuple[str, ...] = ("60", "30")
    centre: tuple[str, ...] = ("0.5", "0.5", "0.5")
    dynamic: bool = False
    up: tuple[str, ...] = ("0", "0", "1")
    zoom: str = "1"
    _first: np.ndarray | None = field(default=None, repr=False)     # the centre of the first picture

    @property
    def moves(self) -> bool:
        return any(w.startswith("v_") for w in (*self.view, *self.up))

    def read(self, key: str, words: list[str], variables, what: str) -> int:
        """Values of one keyword; the number of words used."""
        if key == "center":
            flag, *values = take(words, 4, what)
            if flag not in ("s", "d"):
                raise InputError(f"{what}: expected s (static) or d (dynamic), got {flag!r}")
            self.dynamic, self.centre = flag == "d", tuple(values)
        elif key == "zoom":
            values = take(words, 1, what)
            self.zoom = values[0]
        else:
            values = take(words, {"view": 2, "up": 3}[key], what)
            setattr(self, key, tuple(values))
        for word in values:
            if not word.startswith("v_"):
                number(word, what)
            elif variables is not None:
                variables.find(word[2:])
        if key == "view" and not values[0].startswith("v_") and not 0.0 <= float(values[0]) <= 180.0:
            raise InputError(f"{what}: theta must be between 0 and 180 degrees, got {values[0]}")
        if key == "up" and not any(w.startswith("v_") or float(w) for w in values):
            raise InputError(f"{what}: the direction must not be 0 0 0")
        if key == "zoom" and not values[0].startswith("v_") and float(values[0]) <= 0.0:
            raise InputError(f"{what}: must be positive, got {values[0]}")
        return len(values) + (key == "center")

    def place(self, box, width: int, height: int, variables):
        """A function from points (n, 3) to pixels (n, 3), and pixels per unit of length."""
        def values(words):
            return np.array([variables.number(w[2:]) if w.startswith("v_") else float(w) for w in words])
        theta, phi = np.radians(values(self.view))
        towards = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
        up = values(self.up)
        if np.linalg.norm(np.cross(up, towards)) < 1e-9 * max(np.linalg.norm(up), 1e-300):
            up = np.array([0.0, 1.0, 0.0]) if abs(towards[1]) < 0.9 else np.array([1.0, 0.0, 0.0])      # seen along up
        right = np.cross(up, towards)
        right /= np.linalg.norm(right)
        axes = np.array([right, -np.cross(towards, right), towards])
        centre = box.origin + values(self.centre) @ box.cell
        if not self.dynamic:
            self._first = centre if self._first is None else self._first
            centre = self._first
        corners = (box.origin + CORNERS @ box.cell) - (box.origin + 0.5 * box.cell.sum(axis=0))
        half = np.full(2, np.linalg.norm(corners, axis=1).max()) if self.moves else np.abs(corners @ axes[:2].T).max(axis=0)
        zoom = float(values((self.zoom,))[0])
        if zoom <= 0.0:
            raise InputError(f"dump image: zoom {self.zoom} gave {zoom:g}, it must be positive")
        scale = 0.5 * FILL * zoom * min(width / max(half[0], 1e-12), height / max(half[1], 1e-12))
        middle = np.array([0.5 * width, 0.5 * height, 0.0])
        return (lambda points: scale * (points - centre) @ axes.T + middle), scale
