"""Orientations as unit quaternions w i j k, many at a time."""
from __future__ import annotations

import numpy as np


def unit(q: np.ndarray) -> np.ndarray:
    """(n, 4) of length 1; those that have it to rounding stay as they are."""
    length = np.sqrt((q * q).sum(axis=1))[:, None]
    return np.where(np.abs(length - 1.0) < 1e-14, q, q / length)


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The rotations `q` and then `p`, (n, 4)."""
    a, b, c, d = np.moveaxis(np.asarray(p, float), -1, 0)
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    return np.stack([a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x,
                     a * z + b * y - c * x + d * w], axis=-1)


def axes(q: np.ndarray) -> np.ndarray:
    """(n, 3, 3): rows are the axes of each body in space."""
    a, b, c, d = q.T
    out = np.empty((len(q), 3, 3))
    out[:, 0] = np.column_stack([a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)])
    out[:, 1] = np.column_stack([2.0 * (b * c - a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d + a * b)])
    out[:, 2] = np.column_stack([2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a - b * b - c * c + d * d])
    return out


def turned(q: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Orientations (n, 4) of bodies whose positions become ``x @ rotation``."""
    from scipy.spatial.transform import Rotation
    x, y, z, w = Rotation.from_matrix(np.asarray(rotation).T).as_quat(canonical=True)
    return product(np.array([w, x, y, z]), q)
