r"""Ewald summation: the smooth part of the Coulomb energy as a sum over waves, exact to the accuracy asked for; for small systems.

$$ E = \frac{C}{2 V} \sum_{k \neq 0} \frac{4 \pi}{k^2} e^{-k^2 / 4 g^2} |S(k)|^2 - \frac{C g}{\sqrt{\pi}} \sum_i q_i^2
   - \frac{\pi C}{2 g^2 V} \Big( \sum_i q_i \Big)^2 $$

Waves as LAMMPS chooses them: as many in each direction as the estimate of Kolafa and Perram, Molecular Simulation 9, 351 (1992), wants.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels import ewald
from asemd.kspace import KSpace
from asemd.kspace.term import KSpaceTerm


class Ewald(KSpace):
    """``kspace_style ewald accuracy``."""

    style = flag = "ewald"

    def error(self, waves: int, length: float) -> float:
        """Estimated error of forces by `waves` waves along an edge of that length."""
        g = self.g_ewald
        return (2.0 * self.q2 * g / length * math.sqrt(1.0 / (math.pi * waves * self.n))
                * math.exp(-(math.pi * waves / (g * length)) ** 2))

    def choose(self, system):
        most = list(self.modify["kmax/ewald"])
        if not any(most):
            for d, length in enumerate(self.prd):
                most[d] = 1
                while self.error(most[d], length) > self.accuracy:
                    most[d] += 1
        self.most_upright = tuple(most)
        vectors = system.box.cell * np.array([1.0, 1.0, self.stretch])[:, None]
        reach = 1.00001 * max((2.0 * math.pi * m / length) ** 2 for m, length in zip(most, self.prd))
        if not any(self.modify["kmax/ewald"]) and self._tilted(system):
            upright = system.box.to_lammps()[0].cell if not system.box.is_lammps_frame else system.box.cell
            most = [max(1, int(m)) for m in np.abs(upright) @ (np.array(most) / self.prd)]
        self.most = tuple(most)
        axes = [np.arange(-m, m + 1) for m in self.most]
        n = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        k = 2.0 * math.pi * n @ np.linalg.inv(vectors).T
        half = (n[:, 0] > 0) | ((n[:, 0] == 0) & ((n[:, 1] > 0) | ((n[:, 1] == 0) & (n[:, 2] > 0))))
        self.numbers = np.ascontiguousarray(n[half & ((k * k).sum(axis=1) <= reach)], np.int64)

    def lines(self):
        lpr = math.sqrt(sum(self.error(m, length) ** 2 for m, length in zip(self.most_upright, self.prd)) / 3.0)
        total = math.hypot(lpr, self.real_error)
        most = max(self.most)
        return ["Ewald initialization ...", "  using polynomial approximation for long-range coulomb",
                f"  G vector (1/distance) = {self.g_ewald:.8g}",
                f"  estimated absolute RMS force accuracy = {total:.8g}",
                f"  estimated relative force accuracy = {total / self.two_charges:.8g}",
                f"  KSpace vectors: actual max1d max3d = {len(self.numbers)} {most} {4 * most**3 + 6 * most**2 + 3 * most}",
                f"                  kxmax kymax kzmax  = {' '.join(map(str, self.most))}"]

    def term(self, engine):
        return EwaldTerm(self)


class EwaldTerm(KSpaceTerm):
    """The sum over waves."""

    make_kernel = staticmethod(ewald.kernel)

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        m = len(s.numbers)
        self.waves, self.held, self.inverse = np.zeros((m, 10)), np.zeros((4, 3)), np.zeros((3, 3))
        self.sfac, self.sums, self.most = np.zeros((nth, m, 2)), np.zeros((nth, 8)), np.array(s.most, np.int64)
        self.table = np.zeros((3, 1 + max(s.most), 2, 0))

    def make_room(self, slots):
        if self.table.shape[3] < slots:
            self.table = np.zeros((*self.table.shape[:3], slots))

    def of_solver(self, engine, tid):
        return (self.solver.numbers, self.most, self.waves, self.held, self.inverse, self.table, self.sfac, self.sums, self.constants)
