r"""Ewald summation of 1/r and of the attraction -C_6/r^6, for interfaces and small systems; with lj/long/dipole/long of dipoles too.

$$ E_6 = -\frac{\pi^{3/2}}{24 V} \sum_{k \neq 0} k^3 \Big[ \sqrt{\pi} \, \mathrm{erfc}(b) + \Big( \frac{1}{2 b^3} - \frac{1}{b} \Big)
   e^{-b^2} \Big] \sum_m s_m |S_m(k)|^2 + \frac{g^6}{12} \sum_i C_{ii} - \frac{\pi^{3/2} g^3}{6 V} \sum_{ij} C_{ij},
   \qquad b = \frac{k}{2 g} $$

with C_6 of two types as a sum of products: of its roots for geometric mixing, of the eigenvectors of the matrix of all C_6 for arithmetic
mixing. Both sums have the same splitting parameter and waves, as many as LAMMPS takes for the box as it is. The pressure of
charges that do not add up to 0 has the sign that it has in LAMMPS; as there, ``slab nozforce`` is the correction of a slab without empty
space, and forces along z stay. In 't Veld, Ismail, Grest, J. Chem. Phys. 127, 144711 (2007).
"""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd.errors import InputError, InputWarning
from asemd.kernels import ewald_disp, ewald_disp_dipole
from asemd.kspace.dispersion import dispersion_of
from asemd.kspace.ewald import Ewald, Waves
from asemd.kspace.ewald_dipole import pair_error


class EwaldDisp(Ewald):
    """``kspace_style ewald/disp accuracy``."""

    style = flag = "ewald/disp"
    groups = takes_wire = False
    nozforce = ew2d = 1.0       # as in LAMMPS the correction of a slab without empty space, and forces along z
    partner = "lj/long/coul/long"
    dispersion = None
    dipoles = False             # the pair style leaves it dipoles

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.choice = np.zeros(5)       # what kernels choose waves by

    def take(self, uses, interactions, system):
        self.dipoles = any(use.style.variant(use.settings).oriented == "dipole" for use in uses)
        self.dispersion, parts = dispersion_of(uses, interactions, system, self.style)
        charged = [(use, part) for use in uses for part in use.style.variant(use.settings).parts if part.long and part.charged]
        self.coulomb = bool(charged)
        if charged:
            return self.cutoff_of(charged)
        return float(parts[0][0].settings.get("cut_coul", self.cutoff_of(parts)))       # LAMMPS takes it although nothing ends there

    def count(self, system):
        self.b2 = 0.0
        self.squares_mu = float((np.asarray(system.extra["mu"]) ** 2).sum()) if self.dipoles else 0.0
        if self.dispersion is not None:
            self.b2 = self.dispersion.sums(system.type)[1]
            if self.dispersion.rule == "arithmetic":      # LAMMPS's estimates count a quarter of it then
                self.b2 /= 4.0
        super().count(system)
        self.choice[:4] = self.q2, self.b2, self.m2, self.n

    def first_guess(self):
        if self.coulomb and self.q2 != 0.0:
            return super().first_guess()
        if self.b2 == self.m2 == 0.0:
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

    @property
    def m2(self) -> float:
        """Sum of squared dipoles, in energy times volume."""
        return self.squares_mu * self.scale

    def excess(self, g: float) -> float:
        """By how much the error of the pair part, of dipoles or else of dispersion, is larger than the accuracy."""
        a = self.cutoff * g
        if self.m2:
            return pair_error(self, self.m2, g) - self.accuracy
        return (4.0 * math.pi * self.b2 * g**4 / self.inner.prod() / math.sqrt(self.n) * math.erfc(a)
                * (6.0 / a**5 + 6.0 / a**3 + 3.0 / a + a) - self.accuracy)

    def choose(self, system):
        if self.accuracy >= 1.0:
            raise InputError(f"kspace_style {self.style}: an accuracy of forces of {self.accuracy:g} is too low, it must be below 1")
        if self.modify["gewald/disp"] not in (0.0, self.g_ewald):
            raise InputError(f"kspace_style {self.style} has one splitting parameter: use kspace_modify gewald, not gewald/disp")
        self.choice[4] = self.accuracy
        self.choose_waves(system)

    def choose_waves(self, system):
        vectors = system.box.cell * self.stretch[:, None]
        self.check_size()
        self.waves, self.top = ewald_disp.chooser()(vectors, self.g_ewald, *self.choice, np.zeros((0, 3), np.int64))

    def wave_error(self, waves, length):
        return ewald_disp.error(waves, length, self.g_ewald, self.q2, self.b2, self.m2 / self.volume, self.n)

    def follow(self, waves, most):
        self.waves, self.top = waves, int(most.max())

    @property
    def constants(self):
        return {"g_ewald": self.g_ewald, "g_ewald_6": self.g_ewald}

    def lines(self):
        return ["EwaldDisp initialization ...", f"  G vector = {self.g_ewald:.8g},   accuracy = {self.accuracy:.8g}"]

    def terms(self, engine):
        out: list = [(DipoleWavesTerm(self) if self.dipoles else WavesTerm(self, None))] if self.coulomb else []
        return out + ([WavesTerm(self, self.dispersion)] if self.dispersion is not None else [])


class WavesTerm(Waves):
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

    def count(self, engine):
        super().count(engine)
        if self.dispersion is not None:
            self.constants[7:] = self.dispersion.all_sums(engine.system.type)

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        self.factors, self.signs = np.zeros((0, 1)), np.ones(1)
        if self.dispersion is not None:
            self.factors, self.signs = self.dispersion.factors, self.dispersion.signs
            self.constants = np.append(self.constants[:7], self.dispersion.all_sums(engine.system.type))
        m, top = self.make_waves(engine, s.waves, s.top)
        n, self.most = self.factors.shape[1], np.zeros(3, np.int64)
        self.all_sums, self.sums = np.zeros((nth, n, m, 2)), np.zeros((nth, 8))
        self.values, self.table = np.zeros((n, 0)), np.zeros((3, 1 + top, 2, 0))

    def make_room(self, slots):
        if self.table.shape[3] < slots:
            self.table, self.values = np.zeros((*self.table.shape[:3], slots)), np.zeros((len(self.values), slots))

    def of_solver(self, engine, tid):
        return (engine.state.type, self.factors, self.signs, self.numbers, self.most, self.waves, self.held, self.inverse,
                self.table, self.values, self.all_sums, self.sums, self.constants, self.solver.choice)


class DipoleWavesTerm(Waves):
    """The sum over waves of charges with dipoles; kernels read dipoles where they are, by row, for fixes may turn them."""

    make_kernel, of_places = staticmethod(ewald_disp_dipole.kernel), False

    def count(self, engine):
        super().count(engine)
        self.constants[7] = self.solver.squares_mu

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        self.constants = np.append(self.constants[:7], [s.squares_mu, s.scale])
        m, top = self.make_waves(engine, s.waves, s.top)
        self.all_sums, self.sums, self.most = np.zeros((nth, m, 4)), np.zeros((nth, 8)), np.zeros(3, np.int64)
        self.table = np.zeros((3, 1 + top, 2, 0))

    def make_room(self, slots):
        if self.table.shape[3] < slots:
            self.table = np.zeros((*self.table.shape[:3], slots))

    def of_solver(self, engine, tid):
        return (engine.system.extra["mu"], engine.state.row, engine.buffers[tid, 3:], self.numbers, self.most, self.waves, self.held,
                self.inverse, self.table, self.all_sums, self.sums, self.constants, self.solver.choice)
