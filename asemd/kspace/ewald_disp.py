r"""Ewald summation of 1/r and of the attraction -C_6/r^6, for interfaces and small systems.

$$ E_6 = -\frac{\pi^{3/2}}{24 V} \sum_{k \neq 0} k^3 \Big[ \sqrt{\pi} \, \mathrm{erfc}(b) + \Big( \frac{1}{2 b^3} - \frac{1}{b} \Big)
   e^{-b^2} \Big] \sum_m s_m |S_m(k)|^2 + \frac{g^6}{12} \sum_i C_{ii} - \frac{\pi^{3/2} g^3}{6 V} \sum_{ij} C_{ij},
   \qquad b = \frac{k}{2 g} $$

with C_6 of two types as a sum of products: of its roots for geometric mixing, of the eigenvectors of the matrix of all C_6 for arithmetic
mixing. Both sums have the same splitting parameter and waves, as many as LAMMPS takes for the box at the start of a run. The pressure of
charges that do not add up to 0 has the sign that it has in LAMMPS.  In 't Veld, Ismail, Grest, J. Chem. Phys. 127, 144711 (2007).
"""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd.errors import InputError, InputWarning
from asemd.kernels import ewald_disp
from asemd.kspace.dispersion import dispersion_of
from asemd.kspace.ewald import Ewald
from asemd.kspace.term import KSpaceTerm


class EwaldDisp(Ewald):
    """``kspace_style ewald/disp accuracy``."""

    style = flag = "ewald/disp"
    groups = False
    partner = "lj/long/coul/long"
    dispersion = None

    def take(self, uses, interactions, system):
        self.dispersion, parts = dispersion_of(uses, interactions, system, self.style)
        charged = [(use, part) for use in uses for part in use.style.variant(use.settings).parts if part.long and part.charged]
        self.coulomb = bool(charged)
        return self.cutoff_of(charged or parts)

    def prepare(self, system, interactions, units, cutoff):
        self.b2 = 0.0
        if self.dispersion is not None:
            self.b2 = self.dispersion.sums(system.type)[1]
            if self.dispersion.rule == "arithmetic":      # LAMMPS's estimates count one sixteenth of it then
                self.b2 /= 16.0
        super().prepare(system, interactions, units, cutoff)

    def first_guess(self):
        if self.coulomb and self.q2 != 0.0:
            return super().first_guess()
        if self.b2 == 0.0:
            raise InputError(f"kspace_style {self.style}: there are neither charges nor dispersion; use no kspace_style")
        guess = (1.35 - 0.15 * math.log(self.accuracy)) / self.cutoff
        g = guess
        for _ in range(10000):
            here = self.excess(g)
            step = here / ((self.excess(g + 1e-6) - here) / 1e-6)
            g -= step
            if abs(step) < 1e-5:
                return g
            if not g >= 0.0:
                break
        warnings.warn("kspace_style ewald/disp: no splitting parameter makes the error of the pair part the accuracy; a guess is taken",
                      InputWarning, stacklevel=2)
        return guess

    def excess(self, g: float) -> float:
        """By how much the error of the pair part of dispersion is larger than the accuracy."""
        a = self.cutoff * g
        return (4.0 * math.pi * self.b2 * g**4 / self.inner.prod() / math.sqrt(self.n) * math.erfc(a)
                * (6.0 / a**5 + 6.0 / a**3 + 3.0 / a + a) - self.accuracy)

    def error(self, waves: int, length: float) -> float:
        """Estimated error of forces of both sums by so many waves along an edge."""
        g = self.g_ewald
        u = math.pi * waves / (g * length)
        bell = math.exp(-u * u)
        return (2.0 * self.q2 * g / length * math.sqrt(1.0 / (math.pi * waves * self.n)) * bell
                + 4.0 * self.b2 * g**7 / 3.0 * math.sqrt(1.0 / (math.pi * self.n)) * bell * (u + 1.0))

    def choose(self, system):
        if self.accuracy >= 1.0:
            raise InputError(f"kspace_style {self.style}: an accuracy of forces of {self.accuracy:g} is too low, it must be below 1")
        vectors = system.box.cell * np.array([1.0, 1.0, self.stretch])[:, None]
        turn = 2.0 * math.pi * np.linalg.inv(vectors)
        most = []
        for length in self.prd:
            m = 1
            while self.error(m, length) > self.accuracy:
                m += 1
            most.append(m)
        reach = 1.00001 * max((2.0 * math.pi / length * m) ** 2 for m, length in zip(most, self.prd))
        axis = np.arange(-max(most), max(most) + 1)
        n = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
        half = (n[:, 0] > 0) | ((n[:, 0] == 0) & ((n[:, 1] > 0) | ((n[:, 1] == 0) & (n[:, 2] > 0))))
        k = n @ turn.T
        self.numbers = np.ascontiguousarray(n[half & ((k * k).sum(axis=1) <= reach)], np.int64)
        self.top = max(most)

    @property
    def constants(self):
        return {"g_ewald": self.g_ewald, "g_ewald_6": self.g_ewald}

    def lines(self):
        return ["EwaldDisp initialization ...", f"  G vector = {self.g_ewald:.8g},   accuracy = {self.accuracy:.8g}"]

    def terms(self, engine):
        out = [WavesTerm(self, None)] if self.coulomb else []
        return out + ([WavesTerm(self, self.dispersion)] if self.dispersion is not None else [])


class WavesTerm(KSpaceTerm):
    """The sum over waves of charges, or of the numbers whose products are C6."""

    make_kernel = staticmethod(ewald_disp.kernel)

    def __init__(self, solver, dispersion):
        super().__init__(solver)
        self.dispersion = dispersion
        if dispersion is not None:
            self.constants[1] = solver.scale

    def set_factor(self, factor):
        if self.dispersion is None:
            super().set_factor(factor)

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        self.factors, self.signs = np.zeros((0, 1)), np.ones(1)
        if self.dispersion is not None:
            self.factors, self.signs = self.dispersion.factors, self.dispersion.signs
            everyone, own, each = self.dispersion.sums(engine.system.type)
            self.constants = np.concatenate([self.constants, [everyone, own], each])
        m, n = len(s.numbers), self.factors.shape[1]
        self.waves, self.held, self.inverse = np.zeros((m, 10)), np.zeros((4, 3)), np.zeros((3, 3))
        self.most = np.full(3, s.top, np.int64)
        self.all_sums, self.sums = np.zeros((nth, n, m, 2)), np.zeros((nth, 8))
        self.values, self.table = np.zeros((n, 0)), np.zeros((3, 1 + s.top, 2, 0))

    def make_room(self, slots):
        if self.table.shape[3] < slots:
            self.table, self.values = np.zeros((*self.table.shape[:3], slots)), np.zeros((len(self.values), slots))

    def of_solver(self, engine, tid):
        return (engine.state.type, self.factors, self.signs, self.solver.numbers, self.most, self.waves, self.held, self.inverse,
                self.table, self.values, self.all_sums, self.sums, self.constants)
