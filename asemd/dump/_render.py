"""Pictures of spheres and cylinders: each pixel gets the surface nearest to the viewer, its normal and colour, and is lit.

Objects are exact (no polygons). Coordinates are pixels: x to the right, y down, z towards the viewer; parallel projection.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from asemd.kernels.target import njit

FAR = -1e30
GAMMA = 2.2
# direction towards the light, brightness
LIGHTS = ((np.array([-0.45, -0.65, 0.75]), 0.85), (np.array([0.70, -0.10, 0.60]), 0.22), (np.array([0.10, 0.90, 0.30]), 0.10))
AMBIENT = 0.20


@dataclass
class Objects:
    """Spheres ``centre (n, 3)`` and cylinders ``start, end (m, 3)`` with radii and colours (n, 3) from 0 to 1.

    Cylinders are open; `flat` are those whose `end` is closed by a disc.
    """

    centre: np.ndarray
    radius: np.ndarray
    colour: np.ndarray
    start: np.ndarray
    end: np.ndarray
    width: np.ndarray
    paint: np.ndarray
    flat: np.ndarray


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


@njit(cache=True)
def _light(lit, depth, normal, colour, behind, lights, halves, strength, ambient, shiny, occlusion, fading, near, span):
    """Diffuse light, highlights, dark gaps, fading with depth; `lit` holds the background and gets the sum over the rays of each pixel."""
    h, w, _ = lit.shape
    n = depth.shape[0] // h
    back = lit[0, 0].copy()
    for i in range(h):
        for j in range(w):
            for c in range(3):
                lit[i, j, c] = 0.0
            for k in range(n * n):
                row, column = i * n + k // n, j * n + k % n
                z = depth[row, column]
                if z <= FAR:
                    for c in range(3):
                        lit[i, j, c] += back[c]
                    continue
                x, y, up = normal[row, column, 0], normal[row, column, 1], normal[row, column, 2]
                diffuse, highlight = ambient, 0.0
                for m in range(len(strength)):
                    facing = x * lights[m, 0] + y * lights[m, 1] + up * lights[m, 2]
                    diffuse += strength[m] * max(0.0, (facing + 0.15) / 1.15)       # softer edge of the shade than a bare cosine
                    highlight += strength[m] * max(0.0, x * halves[m, 0] + y * halves[m, 1] + up * halves[m, 2]) ** 60
                if occlusion > 0.0:
                    buried = 0.0
                    for m in range(len(behind)):
                        buried += min(1.0, max(0.0, (behind[m, i, j] - z) / (0.08 * span)))
                    diffuse *= 1.0 - occlusion * buried / len(behind)
                diffuse *= 1.0 - 0.35 * (1.0 - up) ** 3
                fade = fading * ((near - z) / span) ** 1.5
                for c in range(3):
                    light = colour[row, column, c] * diffuse + 0.45 * shiny * highlight
                    lit[i, j, c] += light + (back[c] - light) * fade
            for c in range(3):
                lit[i, j, c] /= n * n


@njit(cache=True)
def _discs(depth, normal, colour, start, end, radius, paint, chosen):
    """The ends of cylinders, where they face the viewer."""
    h, w = depth.shape
    for k in np.flatnonzero(chosen):
        r = radius[k]
        axis = end[k] - start[k]
        length = np.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
        if axis[2] <= 1e-6 * length:
            continue
        ux, uy, uz = axis[0] / length, axis[1] / length, axis[2] / length
        x, y = end[k, 0], end[k, 1]
        for i in range(max(0, int(y - r)), min(h, int(y + r) + 2)):
            for j in range(max(0, int(x - r)), min(w, int(x + r) + 2)):
                dx, dy = j + 0.5 - x, i + 0.5 - y
                dz = -(dx * ux + dy * uy) / uz
                if dx * dx + dy * dy + dz * dz <= r * r and end[k, 2] + dz > depth[i, j]:
                    depth[i, j] = end[k, 2] + dz
                    normal[i, j, 0], normal[i, j, 1], normal[i, j, 2] = ux, uy, uz
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
    _spheres(depth, normal, colour, o.centre * n, o.radius * n, o.colour ** GAMMA)
    _cylinders(depth, normal, colour, o.start * n, o.end * n, o.width * n, o.paint ** GAMMA)
    _discs(depth, normal, colour, o.start * n, o.end * n, o.width * n, o.paint ** GAMMA, o.flat)
    lit = np.empty((height, width, 3))
    lit[:] = np.asarray(look.background) ** GAMMA
    near = depth.max()
    if near > FAR:
        far = depth.min(where=depth > FAR, initial=near)
        lights = np.array([direction / np.linalg.norm(direction) for direction, _ in LIGHTS])
        halves = lights + (0.0, 0.0, 1.0)
        halves /= np.linalg.norm(halves, axis=1)[:, None]
        strength = np.array([s for _, s in LIGHTS])
        behind = _surroundings(depth, n, far) if look.occlusion > 0.0 else np.zeros((0, height, width))
        _light(lit, depth, normal, colour, behind, lights, halves, strength, AMBIENT, look.shiny, look.occlusion, look.fading, near,
               max(near - far, 1e-9))
    return (255.0 * np.clip(lit, 0.0, 1.0) ** (1.0 / GAMMA) + 0.5).astype(np.uint8)


def _surroundings(depth: np.ndarray, n: int, far: float) -> np.ndarray:
    """Mean depth around each pixel over a few distances: what lies behind it is in the shade of near objects."""
    h, w = (m // n for m in depth.shape)
    nearest = np.maximum(depth.reshape(h, n, w, n).max(axis=(1, 3)), far)
    out = []
    for size in (0.006, 0.02):
        blur = max(1.0, size * max(h, w))
        step = max(1, int(blur / 3))        # a smooth picture needs few points
        coarse = gaussian_filter(nearest, 0.4 * step, mode="nearest")[::step, ::step] if step > 1 else nearest
        smooth = gaussian_filter(coarse, blur / step, mode="nearest")
        rows, columns = (np.minimum(np.arange(m) / step, k - 1) for m, k in zip((h, w), coarse.shape))
        out.append(map_coordinates(smooth, np.meshgrid(rows, columns, indexing="ij"), order=1, mode="nearest") if step > 1 else smooth)
    return np.array(out)
