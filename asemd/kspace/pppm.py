r"""Particle-particle particle-mesh: the smooth part of the Coulomb energy on a mesh, by Fourier transforms; for ordinary and large systems.

Charges are spread on the mesh by B-splines of `order` points, multiplied with the influence function that makes the error of forces least,
and differentiated by multiplication with the wave vector (``diff ik``, R. W. Hockney, J. W. Eastwood, Computer Simulation Using Particles,
1989; M. Deserno, C. Holm, J. Chem. Phys. 109, 7678 (1998)). Mesh, splitting parameter and influence function are those that LAMMPS chooses
for the same accuracy: errors are estimated by equation 38 of M. Deserno, C. Holm, J. Chem. Phys. 109, 7694 (1998).
"""
from __future__ import annotations

import math
import warnings

import numpy as np
from numpy.polynomial import Polynomial

from asemd.errors import InputError, InputWarning
from asemd.kernels import pppm, pppm_ad
from asemd.kernels.stencil import WIDE
from asemd.kspace import MOST, KSpace
from asemd.kspace.term import KSpaceTerm
from asemd.kspace.transforms import Transforms

# Deserno and Holm 1998, table I: coefficients of the error of order 1 to 7
ERRORS = ((2 / 3,), (1 / 50, 5 / 294), (1 / 588, 7 / 1440, 21 / 3872), (1 / 4320, 3 / 1936, 7601 / 2271360, 143 / 28800),
          (1 / 23232, 7601 / 13628160, 143 / 69120, 517231 / 106536960, 106640677 / 11737571328),
          (691 / 68140800, 13 / 57600, 47021 / 35512320, 9694607 / 2095994880, 733191589 / 59609088000, 326190917 / 11700633600),
          (1 / 345600, 3617 / 35512320, 745739 / 838397952, 56399353 / 12773376000, 25091609 / 1560084480,
           1755948832039 / 36229939200000, 4887769399 / 37838389248))
SMALL = 1e-5         # LAMMPS stops its search for the splitting parameter there


def pieces(order: int) -> np.ndarray:
    """Weights of the points of the mesh around a charge, as polynomials of its distance from the middle one (order, order)."""
    of = {0: Polynomial([1.0])}
    zero, t = Polynomial([0.0]), Polynomial([0.0, 1.0])
    for p in range(2, order + 1):
        start, step = (0.0, 0) if p % 2 else (0.5, -1)
        x = {m: start - t - m for m in range(-p, p + 1)}
        of = {m: ((0.5 * p + x[m]) * of.get(m + step, zero) + (0.5 * p - x[m]) * of.get(m + 1 + step, zero)) / (p - 1.0)
              for m in range(-((p - 1) // 2), p // 2 + 1)}
    out = np.zeros((order, order))
    for row, m in zip(out, sorted(of)):
        row[:len(of[m].coef)] = of[m].coef
    return out


def aliases(order: int) -> np.ndarray:
    """Coefficients of the sum over images of the squared transform of the weights, in powers of the squared sine."""
    b = np.zeros(order)
    b[0] = 1.0
    for m in range(1, order):
        for k in range(m, 0, -1):
            b[k] = 4.0 * (b[k] * (k - m) * (k - m - 0.5) - b[k - 1] * (k - m - 1) ** 2)
        b[0] = 4.0 * b[0] * m * (m + 0.5)
    return b * (1.0 / math.factorial(2 * order - 1))


class PPPM(KSpace):
    """``kspace_style pppm accuracy``."""

    style = flag = "pppm"
    groups = takes_wire = True
    site_distance = 0.0         # of massless sites from their atoms
    largest_shift = 0.0         # of meshes, in spacings

    def choose(self, system):
        self.order = self.modify["order"]
        if not 2 <= self.order <= 7:
            raise InputError(f"kspace_style {self.style}: order must be 2 to 7, not {self.order}")
        if self.order < self.modify["minorder"]:
            raise InputError(f"kspace_style {self.style}: order {self.order} is less than kspace_modify minorder {self.modify['minorder']}")
        self.ad = self.modify["diff"] == "ad"
        if self.ad and self._tilted(system):
            raise InputError(f"kspace_style {self.style}: kspace_modify diff ad needs a box that is not triclinic")
        self.settle_mesh(system)

    def settle_mesh(self, system) -> None:
        """Mesh, order and splitting parameter of charges."""
        self.choose_mesh(system)
        while self.is_too_wide(self.mesh, self.order):
            self.order = self.narrower(self.order, "order")
            self.choose_mesh(system)
        if not self.modify["gewald"]:
            self.balance()

    def choose_mesh(self, system) -> None:
        """`mesh` and `spacing` for the order."""
        mesh = list(self.modify["mesh"])
        if not any(mesh):
            mesh = self.fine_enough_ad() if self.ad else self.fine_enough()
            if self._tilted(system):
                mesh = [int(m) + 1 for m in self.tilted(mesh)]
        if self.is_too_large(mesh):
            raise self.too_large(mesh)
        self.mesh = tuple(map(with_small_factors, mesh))
        self.spacing = self.prd / self.mesh
        if self._tilted(system):
            self.spacing = 1.0 / np.linalg.solve(self.upright, np.array(self.mesh, float))

    @staticmethod
    def is_too_large(mesh) -> bool:
        """Whether no memory holds such a mesh."""
        return max(mesh) >= MOST or math.prod(mesh) > 2**31

    def is_too_wide(self, mesh, order: int) -> bool:
        """Whether ``kspace_modify overlap no`` forbids the weights of that order: those of an atom that is as far outside of the box as it
        may be between two lists reach further beyond an end of the mesh than the mesh is long."""
        if self.modify["overlap"]:
            return False
        further = (0.5 * self.skin + self.site_distance) * np.linalg.norm(np.linalg.inv(self.upright), axis=0) * mesh
        middle = 0.5 * (order % 2)
        for n, d, stretch in zip(mesh, further, self.stretch):
            below, above = (order - 1) // 2 - math.floor(middle - d), order // 2 + 1 + math.floor(middle + d + self.largest_shift)
            if below > n or (stretch == 1.0 and above > n):
                return True
        return False

    def narrower(self, order: int, keyword: str) -> int:
        """The next lower order.

        Raises
        ------
        InputError
            It is below ``kspace_modify minorder``.
        """
        if order <= (least := self.modify["minorder"]):
            raise InputError(f"kspace_style {self.style}: with kspace_modify overlap no the mesh is too coarse for {keyword} {order}, and "
                             f"minorder {least} allows no lower one; use overlap yes, or a finer mesh")
        warnings.warn(f"kspace_style {self.style}: kspace_modify overlap no reduces {keyword} {order} to {order - 1} on this mesh",
                      InputWarning, stacklevel=2)
        return order - 1

    def fine_enough(self) -> list[int]:
        """Mesh points along each edge so that the error of that direction is below the accuracy; one more than that, as in LAMMPS."""
        mesh = []
        for length in self.prd:
            n, spacing = int(min(length * self.g_ewald, MOST)) + 1, 1.0 / self.g_ewald
            while n < MOST and self.error(spacing, length) > self.accuracy:
                n += 1
                spacing = length / n
            if n >= MOST:
                raise self.too_large([n])
            mesh.append(n + (spacing != 1.0 / self.g_ewald))
        return mesh

    def fine_enough_ad(self) -> list[int]:
        """The same by the error of the whole mesh, for differentiated weights.

        Raises
        ------
        InputError
            The accuracy is not reached.
        """
        spacing = 4.0 / self.g_ewald
        for _ in range(501):
            self.mesh = tuple(max(2, int(length / spacing)) for length in self.prd)
            if self.is_too_large(self.mesh):
                raise self.too_large(self.mesh)
            if self.mesh_error <= self.accuracy:
                return list(self.mesh)
            spacing *= 0.95
        raise InputError(f"kspace_style {self.style}: no mesh reaches the accuracy {self.accuracy_relative:g}")

    def error(self, spacing: float, length: float) -> float:
        """Estimated error of forces along one direction."""
        h = spacing * self.g_ewald
        if h > 1e20:
            return math.inf
        total = sum(c * h ** (2.0 * m) for m, c in enumerate(ERRORS[self.order - 1]))
        return (self.q2 * h**self.order * math.sqrt(self.g_ewald * length * math.sqrt(2.0 * math.pi) * total / self.n) / (length * length))

    @property
    def mesh_error(self) -> float:
        """Estimated error of forces that the mesh makes."""
        if self.ad:
            quality = pppm_ad.quality_of(self.order)(np.array(self.mesh), self.prd, self.g_ewald)
            return math.sqrt(max(quality, 0.0) / self.n) * self.q2 / self.volume
        return math.sqrt(sum(self.error(h, length) ** 2 for h, length in zip(self.spacing, self.prd)) / 3.0)

    @property
    def real_error(self) -> float:
        """Estimated error of forces that the pair part makes; without the empty volume of a slab."""
        volume = float(self.inner.prod())
        g, cut = self.g_ewald, self.cutoff
        return 2.0 * self.q2 * math.exp(-g * g * cut * cut) / math.sqrt(self.n * cut * volume)

    def balance(self) -> None:
        """The splitting parameter for which pair part and mesh make the same error.

        Raises
        ------
        InputError
            There is none for this mesh.
        """
        def difference(g: float) -> float:
            self.g_ewald = g
            return self.real_error - self.mesh_error

        g, h = self.g_ewald, 1e-6
        for _ in range(10000):
            here = difference(g)
            g -= here / ((difference(g + h) - here) / h)
            if not math.isfinite(g) or (g <= 0.0 and not self.ad):
                break
            if abs(difference(g)) < SMALL:
                return
        raise InputError(f"kspace_style {self.style}: no splitting parameter makes the error of the mesh that of the cutoff; "
                         "give kspace_modify gewald, or another mesh")

    def lines(self):
        total = math.hypot(self.mesh_error, self.real_error)
        return ["PPPM initialization ...", "  using polynomial approximation for long-range coulomb",
                f"  G vector (1/distance) = {self.g_ewald:.8g}", f"  grid = {' '.join(map(str, self.mesh))}",
                f"  stencil order = {self.order}", f"  estimated absolute RMS force accuracy = {total:.8g}",
                f"  estimated relative force accuracy = {total / self.two_charges:.8g}"]

    def terms(self, engine):
        return [PPPMTerm(self)]


def with_small_factors(n: int) -> int:
    """The next number that has no prime factors but 2, 3 and 5."""
    while True:
        rest = n
        for p in (2, 3, 5):
            while rest % p == 0:
                rest //= p
        if rest == 1:
            return n
        n += 1


SINGLE = 1e-5


class PPPMTerm(KSpaceTerm):
    """Mesh, weights and transforms; in single precision where forces are, unless the accuracy asked for is better than SINGLE. Weights that
    are differentiated stay in double precision."""

    def __init__(self, solver):
        super().__init__(solver)
        self.order, self.mesh = solver.order, getattr(solver, "mesh", (1, 1, 1))

    def make_kernel(self, level):
        if level == 2 and not self.shares.size:
            self._make_shares()
        return pppm.kernel(level, self.order, self.solver.ad)

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        nx, ny, nz = self.mesh
        nh = nz // 2 + 1
        single = engine.settings.precision == "mixed" and s.accuracy_relative >= SINGLE
        real, waves = (np.float32, np.complex64) if single else (np.float64, np.complex128)
        weights = np.float64 if s.ad else real
        self.numbers, self.pieces, self.aliases = np.array(self.mesh, np.int64), np.zeros((self.order, WIDE), weights), aliases(self.order)
        self.pieces[:, :self.order] = pieces(self.order).T
        # a sum over images that LAMMPS's estimate finds large enough
        self.images = (np.abs(s.upright) @ (s.g_ewald / (math.pi * self.numbers)) * (-math.log(1e-7)) ** 0.25).astype(np.int64)
        self.wrap = np.arange(4 * max(self.mesh) + 8)[None] % self.numbers[:, None]
        self.held, self.inverse, self.green = np.zeros((4, 3)), np.zeros((3, 3)), np.zeros((nx, ny, nh, 4))
        self.lengths, self.own = np.zeros(3), np.zeros((3, 2))
        self.brick, self.density = np.zeros((nth, nx, ny, nz + self.order + 8), weights), np.zeros((nx, ny, nz), real)
        m = 1 if s.ad else 3
        self.wave, self.waves = np.zeros((nx, ny, nh), waves), np.zeros((m, nx, ny, nh), waves)
        self.field, self.packed = np.zeros((m, nx, ny, nz), real), np.zeros((nx, ny, (nz + self.order) * m + 16), weights)
        self.shares, self.share_field = np.zeros((0, nx, ny, nh), complex), np.zeros((0, nx, ny, nz))
        self.sums = np.zeros((nth, 8))
        self.base, self.weight = np.zeros((0, 3), np.int64), np.zeros((0, (6 if s.ad else 3) * WIDE), weights)
        self.transforms = Transforms(self, nth)

    def _make_shares(self) -> None:
        nx, ny, nh = self.wave.shape[-3:]
        self.shares, self.share_field = np.zeros((7, nx, ny, nh), complex), np.zeros((7, *self.mesh))

    def make_room(self, slots):
        if len(self.base) < slots:
            self.base, self.weight = np.zeros((slots, 3), np.int64), np.zeros((slots, self.weight.shape[1]), self.weight.dtype)

    def of_solver(self, engine, tid):
        return (self.numbers, self.pieces, self.aliases, self.wrap, self.images, self.held, self.lengths, self.own, self.inverse,
                self.green, self.brick, self.density, self.wave, self.waves, self.field, self.packed, self.shares, self.share_field,
                self.base, self.weight, self.sums, self.constants, *self.transforms.addresses(tid))
