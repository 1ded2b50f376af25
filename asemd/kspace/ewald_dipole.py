r"""Ewald summation of point dipoles: what pair style lj/cut/dipole/long leaves, as a sum over waves; atoms must not have charges.

$$ E = \frac{C}{2 V} \sum_{k \neq 0} \frac{4 \pi}{k^2} e^{-k^2 / 4 g^2}
   \Big| \sum_i (\vec p_i \cdot \vec k) e^{i \vec k \cdot \vec x_i} \Big|^2 - \frac{2 C g^3}{3 \sqrt{\pi}} \sum_i p_i^2 $$

With kspace_modify slab the waves along z reach as far as the others, where LAMMPS stops too early, and the energy is the one that forces
and torques belong to, where LAMMPS adds a twelfth of the slab's term.

Splitting parameter and waves as LAMMPS chooses them, by the estimates of Z. Wang, C. Holm, J. Chem. Phys. 115, 6351 (2001).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels import ewald_dipole
from asemd.kspace.ewald import Ewald, EwaldTerm


class EwaldDipole(Ewald):
    """``kspace_style ewald/dipole accuracy``."""

    style = flag = "ewald/dipole"
    groups = takes_wire = False

    def check(self, system):
        super().check(system)
        if "mu" not in system.extra:
            raise InputError("kspace_style ewald/dipole needs atoms with dipoles: use atom_style dipole, or hybrid with it")
        if self._tilted(system):
            raise InputError("kspace_style ewald/dipole needs a box that is not triclinic")
        if np.any(system.q):
            raise InputError("kspace_style ewald/dipole needs atoms without charges: set group all charge 0.0")

    def count(self, system):
        self.squares = float((np.asarray(system.extra["mu"]) ** 2).sum()) if "mu" in system.extra else 0.0
        super().count(system)

    @property
    def mu2(self) -> float:
        """Sum of squared dipoles, in energy times volume."""
        return self.squares * self.scale

    def pair_error(self, g: float) -> float:
        """Estimated error of forces that the pair part makes."""
        return pair_error(self, self.mu2, g)

    def first_guess(self):
        if self.accuracy <= 0.0:
            raise InputError(f"kspace_style {self.style}: the accuracy must be positive")
        if self.mu2 == 0.0:
            raise InputError(f"kspace_style {self.style}: all dipoles are 0; give kspace_modify gewald, or use no kspace_style")
        g = self.share_of_error(self.mu2)
        g = (1.35 - 0.15 * math.log(self.accuracy)) / self.cutoff if g >= 1.0 else math.sqrt(-math.log(g)) / self.cutoff
        return self.newton(g) or g

    def newton(self, g: float) -> float:
        """Where the error of the pair part is the one asked for, from `g` on; 0 where none is found."""
        for _ in range(10000):
            value, h = self.pair_error(g) - self.accuracy, 1e-6
            slope = (self.pair_error(g + h) - self.accuracy - value) / h
            step = value / slope
            g -= step
            if not 0.0 < g < math.inf:
                return 0.0
            if abs(step) < 1e-5:
                return g
        return 0.0

    chooser, error = staticmethod(ewald_dipole.chooser), staticmethod(ewald_dipole.error)

    @property
    def strength(self):
        return self.mu2 / self.volume

    @property
    def real_error(self):
        return self.pair_error(self.g_ewald)

    def lines(self):
        """As LAMMPS says it, which estimates no error here."""
        _, table, vectors, _, _, *rest = super().lines()
        return ["EwaldDipole initialization ...", table, vectors, "  estimated absolute RMS force accuracy = 0",
                "  estimated relative force accuracy = 0", *rest]

    def terms(self, engine):
        return [EwaldDipoleTerm(self)]


def pair_error(solver, mu2: float, g: float) -> float:
    """Estimated error of forces that the pair part of dipoles makes; `mu2`: the sum of their squares, in energy times volume."""
    a = (g * solver.cutoff) ** 2
    c, d = 4.0 * a * a + 6.0 * a + 3.0, 8.0 * a**3 + 20.0 * a * a + 30.0 * a + 15.0
    return (mu2 / math.sqrt(solver.inner.prod() * g**4 * solver.cutoff**9 * solver.n)
            * math.sqrt(13.0 / 6.0 * c * c + 2.0 / 15.0 * d * d - 13.0 / 15.0 * c * d) * math.exp(-a))


class EwaldDipoleTerm(EwaldTerm):
    """The sum over waves, with torques; kernels read dipoles where they are, by row, for fixes may turn them."""

    make_kernel, of_places = staticmethod(ewald_dipole.kernel), False

    def prepare(self, engine):
        super().prepare(engine)
        self.sfac = np.zeros((*self.sfac.shape[:2], 6))
        self.count(engine)

    def count(self, engine):
        super().count(engine)
        self.constants[[2, 3, 7]] = 0.0, self.solver.squares, self.solver.mu2

    def of_solver(self, engine, tid):
        return engine.system.extra["mu"], engine.state.row, engine.buffers[tid, 3:], *super().of_solver(engine, tid)
