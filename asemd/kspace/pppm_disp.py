"""Particle-particle particle-mesh of 1/r and of the attraction -C6/r^6, for interfaces and large systems.

Two meshes with splitting parameters of their own; C6 of two types is a sum of products of numbers that the types have, each of which is
spread on the mesh of the attraction like a charge (R. E. Isele-Holder, W. Mitchell, A. E. Ismail, J. Chem. Phys. 137, 174107 (2012)).
A pair style without such an attraction (dispersion
``off``) has the mesh of charges alone. Meshes and parameters are those that LAMMPS chooses; its influence function is simpler than that of
pppm.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pppm_disp
from asemd.kspace.dispersion import dispersion_of
from asemd.kspace.pppm import PPPM, SMALL, PPPMTerm, with_small_factors

LARGE = 10000


class PPPMDisp(PPPM):
    """``kspace_style pppm/disp accuracy``."""

    style = flag = "pppm/disp"
    groups = takes_wire = False
    partner = "lj/long/coul/long long long"
    nozforce, ew2d = 5.0, 1.0   # as in LAMMPS the correction of a slab without empty space; 5: without forces of the mesh along z
    g6 = 0.0

    def take(self, uses, interactions, system):
        self.dispersion, parts = dispersion_of(uses, interactions, system, self.style, self.modify["mix/disp"],
                                               self.modify["splittol"])
        charged = [(use, part) for use in uses for part in use.style.variant(use.settings).parts if part.long and part.charged]
        self.coulomb = bool(charged)
        if parts:
            self.cutoff6 = self.cutoff_of(parts)
        return self.cutoff_of(charged or parts) if charged or parts else 0.0

    def check(self, system):
        super().check(system)
        if self._tilted(system):
            raise InputError(f"kspace_style {self.style} needs a box that is not triclinic; use ewald/disp")
        given = self.modify
        said = (given["disp/auto"] or given["gewald/disp"] or any(given["mesh/disp"]) or given["force/disp/real"] > 0.0
                or given["force/disp/kspace"] > 0.0)
        if self.dispersion and not said:
            raise InputError(f"kspace_style {self.style} needs its accuracy for dispersion: kspace_modify force/disp/real and "
                             "force/disp/kspace, or gewald/disp and mesh/disp, or disp/auto yes")

    def first_guess(self):
        if not self.coulomb:
            return 0.0
        g = self.share_of_error(self.q2) if self.q2 else 1.0
        if g >= 1.0:
            raise InputError(f"kspace_style {self.style}: the accuracy {self.accuracy_relative:g} is too low for these charges")
        return math.sqrt(-math.log(g)) / self.cutoff

    def choose(self, system):
        self.ad = self.modify["diff"] == "ad"
        self.order, self.order6 = self.modify["order"], self.modify["order/disp"]
        for name, order in (("order", self.order), ("order/disp", self.order6)):
            if not 2 <= order <= 7:
                raise InputError(f"kspace_style {self.style}: {name} must be 2 to 7, not {order}")
        if self.coulomb:
            self.settle_mesh(system)
        if self.dispersion:
            self.choose_dispersion(system)

    def choose_mesh(self, system):
        mesh = self.modify["mesh"]
        if not any(mesh):
            mesh = self.mesh_for(self.g_ewald, self.accuracy, self.coulomb_error)
        self.mesh = tuple(map(with_small_factors, mesh))

    def choose_dispersion(self, system) -> None:
        """Mesh and splitting parameter of the attraction."""
        self.c6 = self.dispersion.sums(system.type)[1]
        self.g6 = self.modify["gewald/disp"] or self.guess6()
        self.choose_mesh6()
        while self.is_too_wide(self.mesh6, self.order6):
            self.order6 = self.narrower(self.order6, "order/disp")
            self.choose_mesh6()
        real, wave = (max(self.modify[name], -1.0) for name in ("force/disp/real", "force/disp/kspace"))
        if not self.modify["gewald/disp"] and real == wave:
            self.g6 = self.balanced(self.g6, lambda g: self.real_error6(g) - self.dispersion_error(self.mesh6, g))

    def choose_mesh6(self) -> None:
        """`mesh6` for the order."""
        mesh = self.modify["mesh/disp"]
        if not any(mesh):
            wanted = self.modify["force/disp/kspace"]
            mesh = self.mesh_for(self.g6, wanted if wanted > 0.0 else self.accuracy, self.dispersion_error)
        self.mesh6 = tuple(map(with_small_factors, mesh))

    def coulomb_error(self, mesh, g: float) -> float:
        """Estimated error of forces by that mesh."""
        quality = pppm_disp.quality_of(self.order, self.ad)(np.array(mesh), self.prd, g, False)
        return math.sqrt(max(quality, 0.0) / self.n) * self.q2 / self.volume

    def dispersion_error(self, mesh, g: float) -> float:
        """The same of the attraction."""
        quality = pppm_disp.quality_of(self.order6, self.ad)(np.array(mesh), self.prd, g, True)
        return math.sqrt(max(quality, 0.0) / self.n) * self.c6 / self.volume

    @property
    def mesh_error(self):
        return self.coulomb_error(self.mesh, self.g_ewald)

    def real_error6(self, g: float) -> float:
        """Estimated error of forces that the pair part of the attraction makes."""
        u = (self.cutoff6 * g) ** 2
        return (self.c6 / math.sqrt(self.n * self.volume * self.cutoff6) * math.sqrt(math.pi) * g**5 * math.exp(-u)
                * (1.0 + (3.0 + (6.0 + 6.0 / u) / u) / u))

    def mesh_for(self, g: float, accuracy: float, error) -> list[int]:
        """The first mesh, of ever smaller spacing, whose error is below the accuracy.

        Raises
        ------
        InputError
            There is none.
        """
        spacing = 4.0 / g
        for _ in range(501):
            mesh = [max(2, int(length / spacing)) for length in self.prd]
            if self.is_too_large(mesh):
                raise self.too_large(mesh)
            if error(mesh, g) <= accuracy:
                return mesh
            spacing *= 0.95
        raise InputError(f"kspace_style {self.style}: no mesh reaches the accuracy {accuracy:g} of forces")

    def guess6(self) -> float:
        """The splitting parameter of the attraction for which the pair part makes the error asked for, by halving an interval.

        Raises
        ------
        InputError
            There is none.
        """
        wanted = self.modify["force/disp/real"]
        accuracy = wanted if wanted > 0.0 else self.accuracy
        g = old = 1.0 / self.cutoff6
        more = self.real_error6(g) > accuracy
        for _ in range(1000):
            if (self.real_error6(g) > accuracy) != more or not 1e-100 < g < 1e100:
                break
            old, g = g, g * (2.0 if more else 0.5)
        else:
            raise InputError(f"kspace_style {self.style}: no splitting parameter gives the accuracy {accuracy:g} of dispersion")
        low, high = min(old, g), max(old, g)
        while high - low > SMALL:
            g = low + 0.5 * (high - low)
            if self.real_error6(g) < accuracy:
                high = g
            else:
                low = g
        return low + 0.5 * (high - low)

    def balanced(self, g: float, difference) -> float:
        """Where `difference` vanishes, by Newton's method from g.

        Raises
        ------
        InputError
            It does not get there.
        """
        for _ in range(LARGE):
            here = difference(g)
            g -= here / ((difference(g + 1e-6) - here) / 1e-6)
            if not g > 0.0:
                break
            if abs(difference(g)) < SMALL:
                return g
        raise InputError(f"kspace_style {self.style}: no splitting parameter of dispersion makes the error of the mesh that of the cutoff; "
                         "give kspace_modify gewald/disp and mesh/disp")

    @property
    def constants(self):
        return {"g_ewald": self.g_ewald, "g_ewald_6": self.g6}

    def lines(self):
        out = ["PPPMDisp initialization ..."]
        for name, on, g, mesh, order, errors in (
                ("Coulomb", self.coulomb, self.g_ewald, getattr(self, "mesh", ()), self.order,
                 lambda: (self.mesh_error, self.real_error)),
                ("Dispersion", bool(self.dispersion), self.g6, getattr(self, "mesh6", ()), self.order6,
                 lambda: (self.dispersion_error(self.mesh6, self.g6), self.real_error6(self.g6)))):
            if on:
                total = math.hypot(*errors())
                out += [f"  {name} G vector (1/distance)= {g:.16g}", f"  {name} grid = {' '.join(map(str, mesh))}",
                        f"  {name} stencil order = {order}", f"  {name} estimated absolute RMS force accuracy = {total:.8g}",
                        f"  {name} estimated relative force accuracy = {total / self.two_charges:.8g}"]
        return out

    def terms(self, engine):
        return [MeshTerm(self, attractive) for attractive, on in ((False, self.coulomb), (True, self.dispersion)) if on]


class MeshTerm(PPPMTerm):
    """One of the two meshes."""

    def __init__(self, solver, attractive: bool):
        super().__init__(solver)
        self.attractive = attractive
        self.order, self.mesh, g = (solver.order6, solver.mesh6, solver.g6) if attractive else (solver.order, solver.mesh, solver.g_ewald)
        self.constants[0] = g
        if attractive:
            self.constants[1] = solver.scale

    def set_factor(self, factor):
        if not self.attractive:
            super().set_factor(factor)

    def make_kernel(self, level):
        if level == 2 and not self.shares.size:
            self._make_shares()
        return pppm_disp.kernel(level, self.order, self.solver.ad)

    def count(self, engine):
        super().count(engine)
        if self.attractive:
            self.constants[7:] = self.solver.dispersion.all_sums(engine.system.type)

    def prepare(self, engine):
        self.factors, self.signs = np.zeros((0, 1)), np.ones(1)
        if self.attractive:
            self.factors, self.signs = self.solver.dispersion.factors, self.solver.dispersion.signs
            self.constants = np.append(self.constants[:7], self.solver.dispersion.all_sums(engine.system.type))
        super().prepare(engine)
        n = self.factors.shape[1]
        self.density = np.zeros((n, *self.density.shape), self.density.dtype)
        self.wave = np.zeros((n, *self.wave.shape), self.wave.dtype)
        self.values = np.zeros((n, 0))

    def make_room(self, slots):
        super().make_room(slots)
        if self.values.shape[1] < slots:
            self.values = np.zeros((len(self.values), slots))

    def of_solver(self, engine, tid):
        return (engine.state.type, self.factors, self.signs, self.numbers, self.pieces, self.aliases, self.wrap, self.held, self.lengths,
                self.own, self.inverse, self.green, self.brick, self.density, self.wave, self.waves, self.field, self.packed, self.shares,
                self.share_field, self.base, self.weight, self.values, self.sums, self.constants,
                *self.transforms.addresses(tid))
