r"""Power diagram (Laguerre tessellation) of points with radii: cells of the smallest :math:`|x - x_i|^2 - r_i^2`.

Lifted into four dimensions, :math:`(x, |x|^2 - r^2)`, the points that have cells are those on the lower part of their convex hull. Each of
its facets is a corner of cells, where the powers of four points are equal, and each of its edges a face between two cells.

Source: F. Aurenhammer, SIAM J. Comput. 16, 78 (1987). The hull is ``scipy.spatial.ConvexHull``.
"""
from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

UPRIGHT = 1e-12     # facets this close to upright belong to the rim: their corner is at infinity


class Diagram(NamedTuple):
    """As ``scipy.spatial.Voronoi`` has it, for closed cells; one that reaches infinity has the corner -1, an empty one no corner."""

    points: np.ndarray                      # (n, 3)
    vertices: np.ndarray                    # (m, 3)
    ridge_points: np.ndarray                # (k, 2) the two points of each face
    ridge_vertices: list[np.ndarray]        # its corners, in turn
    regions: list[list[int]]                # (n,) the corners of each cell


def power_diagram(points: np.ndarray, radius: np.ndarray) -> Diagram:
    """The cells of `points` (n, 3) with radii (n,), at least five points that are not in one plane."""
    from scipy.spatial import ConvexHull
    middle = points.mean(axis=0)
    scale = float(np.abs(points - middle).max())
    x = (points - middle) / scale
    hull = ConvexHull(np.column_stack([x, (x * x).sum(axis=1) - (radius / scale) ** 2]))
    lower = hull.equations[:, 3] < -UPRIGHT
    corners, normals = hull.simplices[lower], hull.equations[lower]
    vertices = middle - 0.5 * scale * normals[:, :3] / normals[:, 3:4]
    regions: list[list[int]] = [[] for _ in points]
    for vertex, four in enumerate(corners.tolist()):
        for k in four:
            regions[k].append(vertex)
    for k in np.unique(hull.simplices[~lower]):
        regions[k].append(-1)
    ends = np.sort(np.concatenate([corners[:, pair] for pair in itertools.combinations(range(4), 2)]), axis=1)
    vertex = np.tile(np.arange(len(corners)), 6)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    starts = np.flatnonzero(np.r_[True, (np.diff(ends[order], axis=0) != 0).any(axis=1)])
    pairs = ends[order[starts]]
    faces = [_in_turn(group, vertices, points[b] - points[a])
             for group, (a, b) in zip(np.split(vertex[order], starts[1:]), pairs, strict=True)]
    return Diagram(points, vertices, pairs, faces, regions)


def _in_turn(corners: np.ndarray, vertices: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """The corners of a convex face in the order they have around it."""
    d = vertices[corners] - vertices[corners].mean(axis=0)
    across = np.eye(3)[np.argmin(np.abs(axis))]
    e1 = np.cross(axis, across)
    e2 = np.cross(axis, e1) / np.linalg.norm(axis)
    return corners[np.argsort(np.arctan2(d @ e2, d @ e1))]
