"""Which points are inside a geometry: coordinates ``x (3, n)``, answers into ``out (n,)``; points on the boundary are inside."""
from __future__ import annotations

import math

from asemd.kernels.target import njit


@njit(cache=True, nogil=True)
def block(x, lo, hi, out):
    """A box along the axes."""
    for i in range(len(out)):
        a, b, c = x[0, i], x[1, i], x[2, i]
        out[i] = (a >= lo[0]) & (a <= hi[0]) & (b >= lo[1]) & (b <= hi[1]) & (c >= lo[2]) & (c <= hi[2])


@njit(cache=True, nogil=True)
def sphere(x, center, radius, out):
    """A ball."""
    for i in range(len(out)):
        a, b, c = x[0, i] - center[0], x[1, i] - center[1], x[2, i] - center[2]
        out[i] = math.sqrt(a * a + b * b + c * c) <= radius


@njit(cache=True, nogil=True)
def cone(x, axis, first, second, center, low, slope, lo, hi, out):
    """A cone along an axis, whose radius is `low` at `lo` and grows by `slope`, a numerator and a denominator."""
    for i in range(len(out)):
        h, a, b = x[axis, i], x[first, i] - center[0], x[second, i] - center[1]
        out[i] = (math.sqrt(a * a + b * b) <= low + (h - lo) * slope[0] / slope[1]) & (h >= lo) & (h <= hi)


@njit(cache=True, nogil=True)
def plane(x, point, normal, out):
    """A half space."""
    for i in range(len(out)):
        out[i] = (x[0, i] - point[0]) * normal[0] + (x[1, i] - point[1]) * normal[1] + (x[2, i] - point[2]) * normal[2] >= 0.0


@njit(cache=True, nogil=True)
def prism(x, lo, cell, out):
    """A parallelepiped; rows of `cell` are its edges, the first along x, the second in the plane of x and y."""
    a, b, c, xy, xz, yz = cell[0, 0], cell[1, 1], cell[2, 2], cell[1, 0], cell[2, 0], cell[2, 1]
    ab, bc, abc = a * b, b * c, a * b * c
    across = xy * yz - b * xz
    for i in range(len(out)):
        dx, dy, dz = x[0, i] - lo[0], x[1, i] - lo[1], x[2, i] - lo[2]
        s0 = dx / a - xy * dy / ab + across * dz / abc
        s1 = dy / b - yz * dz / bc
        s2 = dz / c
        out[i] = (s0 >= 0.0) & (s0 <= 1.0) & (s1 >= 0.0) & (s1 <= 1.0) & (s2 >= 0.0) & (s2 <= 1.0)
