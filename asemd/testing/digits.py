"""Digits that the forces of a bonded style lose, told from its own energy with 60 digits.

The style's function is called with numbers of `mpmath`, differences of its energy give the exact forces. One rounding of the vectors
between atoms, amplified by the condition of the geometry, is the unit: 2^-53 (sum over vectors |dF/dd| |d| + |F|).
"""
from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from asemd import coordinates
from asemd.style import VECTORS, Style

DIGITS = 80
LIMIT = 8.0
TINY = (1e-2, 1e-5, 1e-8)


def geometries(style: Style, length: float) -> dict[str, np.ndarray]:
    """Title -> positions (k, 3): ordinary, and as near to singular as doubles allow; bonds are about as long as `length`."""
    out: dict[str, list] = {}
    if style.category == "bond":
        for ratio in (1.13, 0.87, 1.0 + 1e-7, 1e-6, 40.0):
            out[f"r = {ratio * length:.9g}"] = [[0, 0, 0], [ratio, 0, 0]]
    elif style.category == "angle":
        angles = {"60 degrees": 1.047, "110 degrees": 1.92} | {f"{e:g} from 180 degrees": math.pi - e for e in TINY} | {
            f"{e:g} from 0 degrees": e for e in TINY}
        for title, t in angles.items():
            out[title] = [[1.05, 0, 0], [0, 0, 0], [1.2 * math.cos(t), 1.2 * math.sin(t), 0]]
        out["110 degrees, one arm 1000 times shorter"] = [[1e-3, 0, 0], [0, 0, 0], [-0.4, 1.1, 0]]
    else:
        angles = {"phi = 60 degrees": 1.047, "phi = -140 degrees": -2.44} | {
            f"phi {e:+g} from {base} degrees": math.radians(base) + e for base in (0, 90, 180) for e in (1e-2, -1e-8)}
        for title, p in angles.items():
            out[title] = [[-0.4, 0.9, 0], [0, 0, 0], [1.1, 0, 0], [1.5, 0.9 * math.cos(p), 0.9 * math.sin(p)]]
        for e in TINY[1:]:
            out[f"atoms 1 2 3 {e:g} from a line"] = [[-1.0, e, 0], [0, 0, 0], [1.1, 0, 0], [1.5, 0.5, 0.7]]
            out[f"atoms {e:g} from a plane"] = [[0, 0, 0], [1, 0.1, 0], [-0.5, 0.9, 0], [-0.4, -0.8, e]]
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    return {title: length * np.array(x, float) @ turn.T + 0.3 for title, x in out.items()}


class Exact:
    """Energy and forces of one item of a style with numbers of any length."""

    def __init__(self, style: Style, packed):
        import mpmath
        self.mp, self.style, self.pairs = mpmath.mp, style, coordinates.pairs_of(style)
        coeff = [mpmath.mpf(float(v)) for v in packed.coeff[:, 1]]
        arrays = [np.array([[mpmath.mpf(float(v)) for v in row] for row in a], object) for a in packed.arrays]
        rows = iter(coeff)
        self.constants = [arrays[style.arrays.index(n)] if n in style.arrays else next(rows) for n in style.arguments]
        self.potential = self.translated(style.functions())

    def translated(self, functions) -> Callable:
        """The last of the functions, with the mathematics of `mpmath`."""
        from asemd.kernels.generate import plain_source
        mp = self.mp

        class Mathematics:
            inf, nan, pi = mp.inf, mp.nan, +mp.pi
            isfinite, isnan = staticmethod(mp.isfinite), staticmethod(mp.isnan)
            copysign = staticmethod(lambda a, b: abs(a) if b >= 0.0 else -abs(a))
            fabs, pow = staticmethod(abs), staticmethod(mp.power)
            float64 = staticmethod(mp.mpf)

            def __getattr__(self, name):
                return getattr(mp, {"arctan2": "atan2", "arccos": "acos", "arcsin": "asin", "arctan": "atan"}.get(name, name))

        names: dict = {"math": Mathematics(), "np": Mathematics()}
        for function in functions:
            exec(compile(plain_source(function), f"<{self.style.name}>", "exec"), names)
        return names[functions[-1].__name__]

    def values(self, d) -> list:
        """The style's coordinates for its vectors `d`."""
        mp = self.mp

        def dot(a, b):
            return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

        def cross(a, b):
            return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

        def size(a):
            return mp.sqrt(dot(a, a))

        def angle(a, b):
            return mp.atan2(size(cross(a, b)), dot(a, b))

        def value(name):
            if name in VECTORS:
                k = VECTORS.index(name)
                return d[k // 3][k % 3]
            if name in ("phi", "chi"):
                a, b = cross(d[0], d[1]), cross(d[2], d[1])
                phi = mp.atan2(dot(cross(b, a), d[1]) / size(d[1]), dot(a, b))
                return abs(phi) if name == "chi" else phi
            ends = [[sum(w * v[a] for w, v in zip(weights, d)) for a in range(3)] for weights in coordinates.weights_of(self.style)[name]]
            return size(*ends) if len(ends) == 1 else angle(*ends)

        return [value(name) for name in self.style.coordinates]

    def place(self, x: np.ndarray) -> list[float]:
        """The style's coordinates of positions (k, 3)."""
        return [float(v) for v in self.values([[self.mp.mpf(float(p - q)) for p, q in zip(x[i], x[j])] for i, j in self.pairs])]

    def energy(self, d):
        return self.potential(*self.values(d), *self.constants)[0]

    def forces(self, d) -> list:
        """On all atoms, by differences of the energy."""
        e, out = self.energy(d), [[self.mp.mpf(0)] * 3 for _ in range(1 + max(map(max, self.pairs)))]
        for k, (i, j) in enumerate(self.pairs):
            h = self.step(d[k], 32)
            for a in range(3):
                pull = (self.energy(self.moved(d, k, a, -h)) - e) / h
                out[i][a] += pull
                out[j][a] -= pull
        return out

    def step(self, v, digits: int):
        return self.mp.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * self.mp.mpf(10) ** -digits

    def moved(self, d, k, a, h):
        return [[v + h * (m == k and b == a) for b, v in enumerate(row)] for m, row in enumerate(d)]

    def largest(self, forces):
        return max(self.mp.sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) for f in forces)

    def error(self, x: np.ndarray, forces: np.ndarray) -> float:
        """How often the forces (k, 3) at x (k, 3) are off by the rounding error that the geometry asks for."""
        mp = self.mp
        with mp.workdps(DIGITS):
            d = [[mp.mpf(float(x[i][a])) - mp.mpf(float(x[j][a])) for a in range(3)] for i, j in self.pairs]
            want = self.forces(d)
            off = self.largest([[mp.mpf(float(p)) - q for p, q in zip(u, v)] for u, v in zip(forces, want)])
            bar, unit = self.largest(want), mp.mpf(2) ** -53
            if off <= LIMIT * unit * bar:
                return 0.0
            for k in range(len(d)):
                h = self.step(d[k], 16)
                for a in range(3):
                    near = self.forces(self.moved(d, k, a, h))
                    change = self.largest([[(p - q) / h for p, q in zip(u, v)] for u, v in zip(near, want)])
                    bar += change * self.step(d[k], 0)
            return float(off / (bar * unit)) if bar else math.inf
