"""Internal coordinates of many items at once and their derivatives by the bond vectors, for second derivatives of energies.

Vectors are arrays (m, k, 3). Gradients are algebraic and take complex vectors, so that one complex step gives their own derivatives to the
last digit (Squire and Trapp, SIAM Rev. 40, 110 (1998)).
"""
from __future__ import annotations

import numpy as np

from asemd.style import VECTORS

STEP = 1e-30


def pairs_of(style) -> list[tuple[int, int]]:
    """The vectors of a style: places (i, j) in an item, each vector goes from j to i."""
    first = style.coordinates[0]
    if first == "ax":
        centre = style.centre - 1
        others = [k for k in range(3 if style.category == "angle" else 4) if k != centre]
        return [(k, others[1] if style.chain and k == others[2] else centre) for k in others]
    if style.category == "bond":
        return [(0, 1)]
    if style.category == "angle":
        return [(0, 1), (2, 1)]
    return [(0, 1), (1, 2), (3, 2)]


def dot(a, b):
    return (a * b).sum(axis=-1)


def norm(a):
    return np.sqrt(dot(a, a))


def _one(a):
    return a[..., None]


def angle_between(a, b):
    """Angle of two vectors, 0 to pi."""
    return np.arctan2(norm(np.cross(a, b)), dot(a, b))


def angle_gradient(a, b):
    """Derivatives of the angle of two vectors by both; not finite for vectors along one line."""
    n = np.cross(a, b)
    length = norm(n)
    return np.cross(a, n) / _one(dot(a, a) * length), np.cross(n, b) / _one(dot(b, b) * length)


def torsion(v):
    f, g, h = v[:, 0], v[:, 1], v[:, 2]
    a, b = np.cross(f, g), np.cross(h, g)
    return np.arctan2(dot(np.cross(b, a), g) / norm(g), dot(a, b))


def torsion_gradient(v):
    f, g, h = v[:, 0], v[:, 1], v[:, 2]
    a, b, length = np.cross(f, g), np.cross(h, g), norm(g)
    a, b = a / _one(dot(a, a)), b / _one(dot(b, b))
    return np.stack([_one(-length) * a, _one(dot(f, g) / length) * a - _one(dot(h, g) / length) * b, _one(length) * b], axis=1)


def weights_of(style) -> dict[str, tuple]:
    """Lengths and angles of a style's chart: name -> the vector, or the two vectors, as weights of the style's vectors."""
    if style.category == "bond":
        return {"r": ((1,),)}
    if style.category == "angle":
        return {"theta": ((1, 0), (0, 1)), "r12": ((1, 0),), "r32": ((0, 1),), "r13": ((1, -1),)}
    return {"r12": ((1, 0, 0),), "r23": ((0, 1, 0),), "r34": ((0, 0, 1),), "theta1": ((1, 0, 0), (0, -1, 0)),
            "theta2": ((0, 1, 0), (0, 0, 1))}


def values(style, v: np.ndarray) -> np.ndarray:
    """Coordinates (m, nc) of a style for real vectors."""
    out = []
    for name in style.coordinates:
        if name in VECTORS:
            out.append(v.reshape(len(v), -1)[:, VECTORS.index(name)])
        elif name == "phi":
            out.append(torsion(v))
        elif name == "chi":
            out.append(np.abs(torsion(v)))
        else:
            ends = [np.tensordot(v, np.array(w, float), (1, 0)) for w in weights_of(style)[name]]
            out.append(norm(ends[0]) if len(ends) == 1 else angle_between(*ends))
    return np.stack(out, axis=1)


def gradients(style, v: np.ndarray) -> np.ndarray:
    """Derivatives (m, nc, k, 3) of a style's coordinates by its vectors, real or complex."""
    out = []
    for name in style.coordinates:
        if name in VECTORS:
            g = np.zeros_like(v)
            g.reshape(len(v), -1)[:, VECTORS.index(name)] = 1.0
        elif name in ("phi", "chi"):
            g = torsion_gradient(v)
            if name == "chi":
                g = g * np.where(torsion(v.real) < 0.0, -1.0, 1.0)[:, None, None]
        else:
            weights = [np.array(w, float) for w in weights_of(style)[name]]
            ends = [np.tensordot(v, w, (1, 0)) for w in weights]
            parts = [ends[0] / _one(norm(ends[0]))] if len(ends) == 1 else angle_gradient(*ends)
            g = sum(w[None, :, None] * p[:, None, :] for w, p in zip(weights, parts))
        out.append(g)
    return np.stack(out, axis=1)


def hessian(style, v: np.ndarray, slope: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Second derivatives (m, 3k, 3k) of an energy by the vectors, from those by the coordinates.

    Parameters
    ----------
    v : (m, k, 3)
    slope : (m, nc)
    second : (m, nc, nc)
        First and second derivatives of the energy by the coordinates.
    """
    m, size = len(v), v[0].size if len(v) else 3
    if style.coordinates[0] == "ax":
        return second
    dead = (slope == 0.0) & (second == 0.0).all(axis=2)      # a coordinate that does not matter may lack a gradient
    g = gradients(style, v).reshape(m, len(style.coordinates), size)
    g[dead] = 0.0
    out = np.einsum("mab,mai,mbj->mij", second, g, g, optimize=True)
    for i in range(size):
        step = v.reshape(m, size).astype(complex)
        step[:, i] += 1j * STEP
        change = gradients(style, step.reshape(v.shape)).reshape(m, -1, size).imag / STEP
        change[dead] = 0.0
        out[:, i] += np.einsum("ma,maj->mj", slope, change)
    return 0.5 * (out + out.transpose(0, 2, 1))


def straight_hessian(v: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Second derivatives (m, 6, 6) of a function of an angle whose vectors lie on one line and whose slope is zero there.

    Both directions across the line are equal: the limit of `hessian`.
    """
    a, b = v[:, 0], v[:, 1]
    across = np.cross(a, np.eye(3)[np.argmin(np.abs(a), axis=1)])
    out = np.zeros((len(v), 6, 6))
    for e in (across, np.cross(a, across)):
        e = e / _one(norm(e))
        g = np.concatenate([np.cross(a, e) / _one(dot(a, a)), np.cross(e, b) / _one(dot(b, b))], axis=1)
        out += second[:, None, None] * g[:, :, None] * g[:, None, :]
    return out
