"""Correction maps of two torsions in a row: the energy of a cross term by bicubic interpolation, its forces, for `asemd.fix.CMAP`."""
from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from asemd.kernels.generate import FAST, Builder, plain_source
from asemd.kernels.hooks import shared
from asemd.kernels.image import closest_general

GRID = 24
OUT = 22            # numbers of a cross term: energy, virial xx yy zz xy xz yz, forces on five atoms


@functools.cache
def _slopes() -> np.ndarray:
    """(24, 24): slopes at the points, per spacing, of the natural spline through 24 values continued by 12 on both sides."""
    n, half = 2 * GRID, GRID // 2
    left, right = 4.0 * np.eye(n), np.zeros((n, n))
    left[0, 0] = left[-1, -1] = 2.0
    for k in range(n - 1):
        left[k, k + 1] = left[k + 1, k] = 1.0
    for k in range(n):
        right[k, min(k + 1, n - 1)] += 3.0
        right[k, max(k - 1, 0)] -= 3.0
    continued = np.eye(GRID)[(np.arange(n) - half) % GRID]
    return (np.linalg.solve(left, right) @ continued)[half:half + GRID]


def with_slopes(maps: np.ndarray) -> np.ndarray:
    """(m, 24, 24, 4) values of maps (m, 24, 24) with their slopes in phi, in psi and the mixed ones, per spacing."""
    d = _slopes()
    return np.ascontiguousarray(np.stack([maps, d @ maps, maps @ d.T, d @ maps @ d.T], axis=-1))


def torsion(f, g, h, grad):
    """The angle of a torsion with f = x1 - x2, g = x2 - x3, h = x4 - x3; its gradients for the atoms (4, 3)."""
    ax, ay, az = f[1] * g[2] - f[2] * g[1], f[2] * g[0] - f[0] * g[2], f[0] * g[1] - f[1] * g[0]
    bx, by, bz = h[1] * g[2] - h[2] * g[1], h[2] * g[0] - h[0] * g[2], h[0] * g[1] - h[1] * g[0]
    aa, bb, gg = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, g[0] * g[0] + g[1] * g[1] + g[2] * g[2]
    length = math.sqrt(gg)
    sine = ((by * az - bz * ay) * g[0] + (bz * ax - bx * az) * g[1] + (bx * ay - by * ax) * g[2]) / length
    fg, hg = (f[0] * g[0] + f[1] * g[1] + f[2] * g[2]) / gg, (h[0] * g[0] + h[1] * g[1] + h[2] * g[2]) / gg
    wa, wb = -length / aa, length / bb
    a, b = (wa * ax, wa * ay, wa * az), (wb * bx, wb * by, wb * bz)
    for d in range(3):
        inner = -fg * a[d] - hg * b[d]
        grad[0, d], grad[1, d], grad[2, d], grad[3, d] = a[d], inner - a[d], -inner - b[d], b[d]
    return math.atan2(sine, ax * bx + ay * by + az * bz)


def place(angle):
    """The cell of a grid in which an angle is, and where in it, from 0 to 1."""
    u = (angle + math.pi) * (24.0 / (2.0 * math.pi))
    if not u < 24.0:        # half a turn, or not a number
        return 0, u - 24.0
    k = int(u)
    return k, u - k


def bicubic(grid, phi, psi):
    """Energy and its slopes in phi and psi (radians) of a map with slopes (24, 24, 4)."""
    i, t = place(phi)
    j, u = place(psi)
    e, e1, e2 = 0.0, 0.0, 0.0
    for n in range(2):
        row = (i + n) % 24
        p = t * t * (3.0 - 2.0 * t)
        p, q = (p, t * t * (t - 1.0)) if n else (1.0 - p, t * (t - 1.0) * (t - 1.0))
        dp, dq = 6.0 * t * (1.0 - t) * (2 * n - 1), (3.0 * t - 2.0) * t if n else (3.0 * t - 1.0) * (t - 1.0)
        for m in range(2):
            c = grid[row, (j + m) % 24]
            r = u * u * (3.0 - 2.0 * u)
            r, s = (r, u * u * (u - 1.0)) if m else (1.0 - r, u * (u - 1.0) * (u - 1.0))
            dr, ds = 6.0 * u * (1.0 - u) * (2 * m - 1), (3.0 * u - 2.0) * u if m else (3.0 * u - 1.0) * (u - 1.0)
            value, slope = r * c[0] + s * c[2], r * c[1] + s * c[3]
            e += p * value + q * slope
            e1 += dp * value + dq * slope
            e2 += p * (dr * c[0] + ds * c[2]) + q * (dr * c[1] + ds * c[3])
    return e, e1 * (24.0 / (2.0 * math.pi)), e2 * (24.0 / (2.0 * math.pi))


def cross_term(x, slot, cell, item, grid, out, grad):
    """One cross term: energy, virial and forces into `out` (22,); `grad` (2, 4, 3) is room for the gradients of both angles."""
    i, j, k, l, m = slot[item[0]], slot[item[1]], slot[item[2]], slot[item[3]], slot[item[4]]
    f = closest_general(x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j], cell)
    g = closest_general(x[0, j] - x[0, k], x[1, j] - x[1, k], x[2, j] - x[2, k], cell)
    h = closest_general(x[0, l] - x[0, k], x[1, l] - x[1, k], x[2, l] - x[2, k], cell)
    w = closest_general(x[0, m] - x[0, l], x[1, m] - x[1, l], x[2, m] - x[2, l], cell)
    phi = torsion(f, g, h, grad[0])
    psi = torsion(g, (-h[0], -h[1], -h[2]), w, grad[1])
    out[0], slope1, slope2 = bicubic(grid, phi, psi)
    for n in range(5):
        for d in range(3):
            first, last = grad[0, n, d] if n < 4 else 0.0, grad[1, n - 1, d] if n else 0.0
            out[7 + 3 * n + d] = -slope1 * first - slope2 * last
    for c in range(6):      # places of the atoms counted from the third one: g + f, g, 0, h, h + w
        p, q = (c, c) if c < 3 else (0, c - 2) if c < 5 else (1, 2)
        out[1 + c] = (out[7 + p] * (g[q] + f[q]) + out[10 + p] * g[q] + out[16 + p] * h[q] + out[19 + p] * (h[q] + w[q]))


def cross_terms(x, slot, cell, items, types, grids, out, grad, first, last):
    """Cross terms number `first` to `last` - 1."""
    for n in range(first, last):
        cross_term(x, slot, cell, items[n], grids[types[n] - 1], out[n], grad)


USES = (closest_general, torsion, place, bicubic, cross_term, cross_terms)


@functools.cache
def evaluator() -> Callable:
    """`cross_terms`, compiled, to be called from Python."""
    b = Builder("Cross terms")
    b.use(shared(cross_term, USES), "cross_term")
    b.text(plain_source(cross_terms), f"fastmath={FAST}")
    return b.build().cross_terms
