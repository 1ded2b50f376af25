"""Pictures of spheres and cylinders: each pixel gets the surface nearest to the viewer, its normal and colour, and is lit.

Objects are exact (no polygons). Coordinates are pixels: x to the right, y down, z towards the viewer; parallel projection.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

from asemd.kernels.target import njit

FAR = -1e30
GAMMA = 2.2
# direction towards the light, brightness
LIGHTS = ((np.array([-0.45, -0.65, 0.75]), 0.85), (np.array([0.70, -0.10, 0.60]), 0.22), (np.array([0.10, 0.90, 0.30]), 0.10))
AMBIENT = 0.20


@dataclass
class Objects:
    """Spheres ``centre (n, 3)`` and cylinders ``start, end (m, 3)`` with radii and colours (n, 3) from 0 to 1."""

    centre: np.ndarray
    radius: np.ndarray
    colour: np.ndarray
    start: np.ndarray
    end: np.ndarray
    width: np.ndarray
    paint: np.ndarray


@dataclass
class Look:
    """How surfaces look.

    Attributes
    ----------
    background : (3,) float
    shiny : float
        0 to 1: highlights.
    occlusion : float
        0 to 1: how dark gaps between objects are.
    fading : float
        0 to 1: how far the rearmost objects fade into the background.
    samples : int
        Rays along each edge of a pixel.
    """

    background: np.ndarray
    shiny: float = 1.0
    occlusion: float = 0.0
    fading: float = 0.4
    samples: int = 2


@njit(cache=True)
def _spheres(depth, normal, colour, centre, radius, paint):
    h, w = depth.shape
    for k in range(len(radius)):
        x, y, z, r = centre[k, 0], centre[k, 1], centre[k, 2], radius[k]
        for i in range(max(0, int(y - r)), min(h, int(y + r) + 2)):
            dy = i + 0.5 - y
            for j in range(max(0, int(x - r)), min(w, int(x + r) + 2)):
                dx = j + 0.5 - x
                s = r * r - dx * dx - dy * dy
                if s <= 0.0:
                    continue
                dz = np.sqrt(s)
                if z + dz > depth[i, j]:
                    depth[i, j] = z + dz
                    normal[i, j, 0], normal[i, j, 1], normal[i, j, 2] = dx / r, dy / r, dz / r
                    for c in range(3):
                        colour[i, j, c] = paint[k, c]


@njit(cache=True)
def _cylinders(depth, normal, colour, start, end, radius, paint):
    h, w = depth.shape
    for k in range(len(radius)):
        r = radius[k]
        axis = end[k] - start[k]
        length = np.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
        if length == 0.0:
            continue
        ux, uy, uz = axis[0] / length, axis[1] / length, axis[2] / length
        across = 1.0 - uz * uz
        if across < 1e-12:      # seen from its end
            continue
        ax, ay, az = start[k, 0], start[k, 1], start[k, 2]
        xlo, xhi = min(ax, end[k, 0]) - r, max(ax, end[k, 0]) + r
        ylo, yhi = min(ay, end[k, 1]) - r, max(ay, end[k, 1]) + r
        flat = np.sqrt(across)
        for i in range(max(0, int(ylo)), min(h, int(yhi) + 2)):
            my = i + 0.5 - ay
            for j in range(max(0, int(xlo)), min(w, int(xhi) + 2)):
                mx = j + 0.5 - ax
                if abs(mx * uy - my * ux) > r * flat:       # beside the axis
                    continue
                along = mx * ux + my * uy - az * uz
                b = -az - along * uz
                s = b * b - across * (mx * mx + my * my + az * az - along * along - r * r)
                if s < 0.0:
                    continue
                z = (-b + np.sqrt(s)) / across
                at = along + z * uz
                if at < 0.0 or at > length or z <= depth[i, j]:
                    continue
                depth[i, j] = z
                normal[i, j, 0], normal[i, j, 1] = (mx - at * ux) / r, (my - at * uy) / r
                normal[i, j, 2] = (z - az - at * uz) / r
                for c in range(3):
                    colour[i, j, c] = paint[k, c]


def render(width: int, height: int, objects: Objects, look: Look) -> np.ndarray:
    """The picture.

    Returns
    -------
    (height, width, 3) uint8 array
    """
    n = look.samples
    shape = (height * n, width * n)
    depth, normal, colour = np.full(shape, FAR), np.zeros((*shape, 3), np.float32), np.zeros((*shape, 3), np.float32)
    o = objects
    _spheres(depth, normal, colour, o.centre * n, o.radius * n, o.colour)
    _cylinders(depth, normal, colour, o.start * n, o.end * n, o.width * n, o.paint)
    hit = depth > FAR
    lit = np.empty((*shape, 3), np.float32)
    lit[:] = np.asarray(look.background) ** GAMMA
    if hit.any():
        _light(lit, hit, depth, normal, colour ** GAMMA, look)
    lit = lit.reshape(height, n, width, n, 3).mean(axis=(1, 3))
    return (255.0 * np.clip(lit, 0.0, 1.0) ** (1.0 / GAMMA) + 0.5).astype(np.uint8)


def _light(lit, hit, depth, normal, colour, look: Look) -> None:
    """Diffuse light, highlights, dark gaps, fading with depth."""
    facing = normal[hit]
    diffuse, highlight = np.full(len(facing), AMBIENT), np.zeros(len(facing))
    for direction, strength in LIGHTS:
        direction = direction / np.linalg.norm(direction)
        half = direction + (0.0, 0.0, 1.0)
        half /= np.linalg.norm(half)
        wrapped = np.clip((facing @ direction + 0.15) / 1.15, 0.0, None)        # softer edge of the shade than a bare cosine
        diffuse += strength * wrapped
        highlight += strength * np.clip(facing @ half, 0.0, None) ** 60
    near, far = depth[hit].max(), depth[hit].min()
    span = max(near - far, 1e-9)
    if look.occlusion > 0.0:
        diffuse *= 1.0 - look.occlusion * _buried(depth, hit, span)[hit]
    rim = (1.0 - facing[:, 2]) ** 3
    light = colour[hit] * (diffuse * (1.0 - 0.35 * rim))[:, None] + 0.45 * look.shiny * highlight[:, None]
    fade = look.fading * ((near - depth[hit]) / span) ** 1.5
    lit[hit] = light + (lit[hit] - light) * fade[:, None]


def _buried(depth, hit, span: float) -> np.ndarray:
    """How far each pixel lies behind its surroundings, 0 to 1: near objects shade what is behind them."""
    full = np.where(hit, depth, depth[hit].min())
    out = np.zeros_like(full)
    for size in (0.006, 0.02):
        blur = max(1.0, size * max(depth.shape))
        out += np.clip((gaussian_filter(full, blur, mode="nearest") - full) / (0.08 * span), 0.0, 1.0)
    return 0.5 * out
