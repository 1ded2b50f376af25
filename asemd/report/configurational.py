r"""The temperature that a configuration shows by its forces and their derivatives.

.. math:: k_B T = \frac{\langle |\nabla U|^2 \rangle}{\langle \nabla^2 U \rangle}

Source: H. H. Rugh, Phys. Rev. Lett. 78, 772 (1997); B. D. Butler et al., J. Chem. Phys. 109, 6519 (1998). Units: temperature.
"""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asemd import units as unit_styles
from asemd.engine import Engine
from asemd.scene import Scene

DIRECTIONS = 1500       # displaced atoms for one temperature
DISPLACEMENT = 1e-5     # of each atom, times a typical distance
EXACT = 60              # coordinates up to which each one is displaced by itself


class Probe:
    """Measures the configurational temperature of a scene with an engine of its own, in double precision.

    The sum of second derivatives is the mean of ``z H z`` over random signs z, from forces at two displaced places; systems of few atoms
    displace each coordinate by itself, which leaves no scatter.
    """

    def __init__(self, scene: Scene, seed: int = 1):
        self.engine = Engine(scene.system.copy(), scene.interactions, replace(scene.settings(), precision="double", threads=1))
        self.boltz = unit_styles.get(scene.units).boltz
        system = scene.system
        n, self.axes = system.n, system.dimension
        volume = abs(float(np.linalg.det(system.box.cell)))
        self.step = DISPLACEMENT * min(1.0, (volume / max(n, 1)) ** (1.0 / 3.0))
        self.random, self.count = np.random.default_rng(seed), max(1, DIRECTIONS // max(n, 1))
        self.moving = np.ones(n, bool)
        if any(f.integrates for f in scene.fixes.values()):
            self.moving = np.any([scene.groups.mask(f.group) for f in scene.fixes.values() if f.integrates], axis=0)

    def _forces(self, x: np.ndarray) -> np.ndarray:
        self.engine.move(x)
        return self.engine.collect().forces.copy()

    def _directions(self, n: int):
        rows = np.flatnonzero(self.moving)
        if self.axes * len(rows) <= EXACT:
            for i in rows:
                for a in range(self.axes):
                    z = np.zeros((n, 3))
                    z[i, a] = 1.0
                    yield z, 1.0
        else:
            for _ in range(self.count):
                z = np.zeros((n, 3))
                z[rows, :self.axes] = self.random.choice((-1.0, 1.0), (len(rows), self.axes))
                yield z, 1.0 / self.count

    def temperature(self, system) -> float:
        """Of the positions of a system; nan where the sum of second derivatives is not positive."""
        x, h = system.x.copy(), self.step
        f = self._forces(x)[self.moving]
        laplacian = sum(w * float((z * (self._forces(x - h * z) - self._forces(x + h * z))).sum()) / (2.0 * h)
                        for z, w in self._directions(len(x)))
        return float((f * f).sum()) / (laplacian * self.boltz) if laplacian > 0.0 else math.nan
