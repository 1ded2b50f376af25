r"""Multilevel summation of the Coulomb interaction: 1/r in parts that are ever smoother, each on a coarser grid; for any boundary.

$$ \frac{1}{r} = \Big[ \frac{1}{r} - \frac{1}{a} \gamma\!\Big( \frac{r}{a} \Big) \Big]
   + \sum_{n \geq 0} \Big[ \frac{1}{a_n} \gamma\!\Big( \frac{r}{a_n} \Big)
   - \frac{1}{2 a_n} \gamma\!\Big( \frac{r}{2 a_n} \Big) \Big], \qquad a_n = 2^n a $$

gamma(u) is 1/u beyond 1 and the Taylor polynomial of it in u^2 around 1 before. The bracket of the pair style ends at the cutoff a, that of
level n at 2 a_n; it is summed on a grid of 2^n times the finest spacing, to which charges are brought from grid to grid. In a
periodic box the coarsest grid has one point, and no charge; otherwise it has the rest of the sum. Forces are the gradient of the energy.

Grid, and the cutoff of the pair style where ``kspace_modify cutoff/adjust`` leaves it to the solver (the default), are LAMMPS's. With
``pressure/scalar yes``, the default, LAMMPS puts the energy of charges in the place of their virial, the same to the accuracy of the
method, and has no components of pressure; here pressure is always that of the virial.

D. J. Hardy, Multilevel summation for the fast evaluation of forces for the simulation of biomolecules, thesis, University of Illinois,
2006; D. J. Hardy et al., J. Chem. Theory Comput. 12, 2892 (2016).
"""
from __future__ import annotations

import math
import warnings
from functools import cache

import numpy as np
from numpy.polynomial import Polynomial

from asemd.errors import InputError, InputWarning
from asemd.kernels import msm
from asemd.kernels.callback import Callback
from asemd.kspace import MOST, KSpace
from asemd.kspace.term import KSpaceTerm

# of order 4, 6, 8, 10: M and c' of the thesis (table 5.1, equation 4.17), and a factor that makes an estimate of the mean of its bound
BOUNDS = {4: (9.0, 1 / 6, 0.39189561), 6: (825.0, 1 / 30, 0.150829428), 8: (130095.0, 1 / 140, 0.049632967),
          10: (34096545.0, 1 / 630, 0.013520855)}


def smoothed(order: int) -> list[float]:
    """Coefficients of the Taylor polynomial of 1/sqrt(u) around 1 in powers of u, of half the degree of the order."""
    degree = order // 2
    taylor = [math.prod(-0.5 - m for m in range(k)) / math.factorial(k) for k in range(degree + 1)]
    return [sum(taylor[k] * math.comb(k, n) * (-1.0) ** (k - n) for k in range(n, degree + 1)) for n in range(6)]


def of_pairs(smooth: list[float], cutoff: float) -> dict[str, float]:
    """What pair styles take of these coefficients."""
    return {f"smooth{n}": c / cutoff ** (2 * n + 1) for n, c in enumerate(smooth)}


@cache
def pieces(order: int) -> list[Polynomial]:
    """Weights of the points around a charge, as polynomials of its place between the two in the middle: linear blends of the two
    polynomials of degree order - 2 that go through the points around the left and around the right one."""
    half, t = order // 2, Polynomial([0.0, 1.0])
    out = []
    for point in range(1 - half, half + 1):
        total = Polynomial([0.0])
        for centre, share in ((0, 1.0 - t), (1, t)):
            others = [k for k in range(centre + 1 - half, centre + half) if k != point]
            if len(others) == order - 2:
                total += share * math.prod(((t - k) / (point - k) for k in others), start=Polynomial([1.0]))
        out.append(total)
    return out


def nodal(order: int, u: np.ndarray) -> np.ndarray:
    """The weight of a point at a distance, in spacings."""
    left, of = np.floor(-u).astype(int), pieces(order)
    out = np.zeros(len(u))
    for k, (a, b) in enumerate(zip(left, -u)):
        if -order // 2 <= a < order // 2:
            out[k] = of[order // 2 - 1 - a](b - a)
    return out


class MSM(KSpace):
    """``kspace_style msm accuracy``."""

    style = flag = "msm"
    partner = "lj/cut/coul/msm"
    usual_order = 10

    def check(self, system):
        name = f"kspace_style {self.style}"
        if system.dimension == 2:
            raise InputError(f"{name} needs three dimensions, this scene has two")
        if system.q is None:
            raise InputError(f"{name} needs atom attribute q: use atom_style charge or full")
        if self.slab is not None:
            raise InputError(f"{name} does not take kspace_modify slab: it works with any boundary")

    def take(self, uses, interactions, system):
        self.cut_by = [(use.settings, part.cut) for use in uses for part in use.style.variant(use.settings).parts if part.long]
        return super().take(uses, interactions, system)

    def count(self, system):
        super().count(system)
        if abs(self.qsum) > 1e-5:
            raise InputError(f"kspace_style {self.style}: charges must add up to 0, here they add up to {self.qsum:g}")

    def first_guess(self):
        return 0.0

    def choose(self, system):
        if not self.q2:
            warnings.warn("Using kspace solver on system with no charge", InputWarning, stacklevel=2)
        self.order = self.modify["order"]
        if self.order not in BOUNDS:
            raise InputError(f"kspace_style {self.style}: order must be 4, 6, 8 or 10, not {self.order}")
        if not self.cutoff ** (self.order - 1) > 0.0:
            raise self.impossible(self.q2)
        self.smooth = smoothed(self.order)
        self.periodic = np.array(system.box.periodic, bool)
        given, adjust = self.modify["mesh"], self.modify["cutoff/adjust"]
        mesh = np.array(given if any(given) else self.cheapest() if adjust else self.fine_enough(), float)
        if self._tilted(system) and not any(given):
            mesh = self.tilted(mesh).astype(int)
        self.mesh = tuple(2 ** round(math.log2(max(n, 1))) for n in mesh)
        if any(given) and self.mesh != tuple(given):
            warnings.warn("Number of MSM mesh points changed to be a multiple of 2", InputWarning, stacklevel=2)
        self.spacing = self.prd / self.mesh
        self.adjusts = adjust and self.q2 > 0.0       # without charges there is no error to match
        if self.adjusts:
            p = self.order - 1
            self.cutoff = (self.cutoff**p * self.mesh_error / self.accuracy) ** (1.0 / p)
            for settings, name in self.cut_by:
                settings[name] = self.cutoff
        if self.mesh == (1, 1, 1):
            warnings.warn("MSM mesh too small, increasing to 2 points in each direction", InputWarning, stacklevel=2)
            self.mesh = (2, 2, 2)
        if self._tilted(system):
            self.spacing = 1.0 / np.linalg.solve(self.upright, np.array(self.mesh, float))

    def cheapest(self) -> list[int]:
        """The grid for which the estimated work is least, whatever the cutoff then is."""
        p = self.order - 1
        work = 3072.0 * (p + 1) / (p - 1) / (448.0 * math.pi + 28.0 * math.pi * self.order + 1701.0)
        spacing = work ** (1.0 / 6.0) / (self.n / float(self.prd.prod())) ** (1.0 / 3.0)
        return [max(2, int(length / spacing)) for length in self.prd]

    def fine_enough(self) -> list[int]:
        """The first powers of 2, from 4 on, for which the error along each direction is below the accuracy."""
        out = []
        for length in self.prd:
            n = 4
            while self.error(length / n, length) > self.accuracy:
                n *= 2
                if n > MOST:
                    raise self.too_large([n])
            out.append(n)
        return out

    def error(self, spacing: float, length: float) -> float:
        """Estimated error of forces along one direction."""
        bound, c, mean = BOUNDS[self.order]
        p = self.order - 1
        return 4.0 / 3.0 * c * bound * mean * spacing ** (p - 1) / self.cutoff**p * self.q2 / (length * math.sqrt(self.n))

    @property
    def mesh_error(self) -> float:
        """Estimated error of forces."""
        return math.sqrt(sum(self.error(h, length) ** 2 for h, length in zip(self.spacing, self.prd)) / 3.0)

    @property
    def constants(self):
        return of_pairs(self.smooth, self.cutoff)

    @property
    def own(self) -> float:
        """The smooth potential of a charge where it is."""
        return self.smooth[0] / self.cutoff

    def lines(self):
        out = ["MSM initialization ..."]
        if self.adjusts:
            out.append(f"WARNING: Adjusting Coulombic cutoff for MSM, new cutoff = {self.cutoff:.8g}")
        return [*out, "  using polynomial approximation for long-range coulomb",
                f"  estimated absolute RMS force accuracy = {self.mesh_error:.8g}",
                f"  estimated relative force accuracy = {self.mesh_error / self.two_charges:.8g}",
                f"  grid = {' '.join(map(str, self.mesh))}", f"  order = {self.order}"]

    def terms(self, engine):
        return [MSMTerm(self)]


class Level:
    """A grid: its points along each direction, and the sums over it as products of Fourier transforms.

    Parameters
    ----------
    solver : MSM
    n : int
        0: the finest one; a grid has 2^n times its spacing.
    first, count : (3,)
        First point and number of points along each direction.
    top : bool
        The last one of a box that is not periodic, which has all that is left of 1/r.
    """

    def __init__(self, solver: MSM, n: int, points, first, count, top: bool):
        self.solver, self.n, self.points, self.first, self.count, self.top = solver, n, points, first, count, top

    def tune(self, vectors: np.ndarray, reach, virial: bool) -> None:
        """The interaction of points in a box: transforms of it and, if `virial`, of the six parts of its virial.

        Parameters
        ----------
        reach : (3,) int
            How many points of the finest grid there are in twice the cutoff.
        """
        from scipy import fft
        s, a = self.solver, self.solver.cutoff * 2.0**self.n
        reach = np.where(s.periodic, 0 if self.top else reach, self.count - 1 if self.top else np.minimum(reach, self.count - 1))
        self.shape = tuple(c if p else fft.next_fast_len(int(c + m), real=True) for c, p, m in zip(self.count, s.periodic, reach))
        steps = [np.arange(-m, m + 1) for m in reach]
        d = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1) @ (vectors / np.array(self.points)[:, None])
        square = (d * d).sum(axis=-1)
        value, slope = self._smooth(square, a)
        if not self.top:
            further, flatter = self._smooth(square, 2.0 * a)
            value, slope = value - further, slope - flatter
        at = np.ix_(*(k % m for k, m in zip(steps, self.shape)))
        pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] if virial else []
        values = [value, *(-slope * d[..., i] * d[..., j] for i, j in pairs)]
        self.kernels = np.empty((len(values), *self.shape[:2], self.shape[2] // 2 + 1))
        for out, v in zip(self.kernels, values):
            folded = np.zeros(self.shape)
            np.add.at(folded, at, v)
            out[:] = fft.rfftn(folded).real           # an even function

    def _smooth(self, square: np.ndarray, a: float) -> tuple[np.ndarray, np.ndarray]:
        """gamma(r/a)/a and its derivative divided by r."""
        u, c = square / (a * a), self.solver.smooth
        near = u <= 1.0
        inside, far = np.where(near, u, 1.0), np.where(near, 1.0, u)
        value = np.where(near, np.polyval(c[::-1], inside), 1.0 / np.sqrt(far))
        slope = np.where(near, 2.0 * np.polyval([k * c[k] for k in range(5, 0, -1)], inside), -1.0 / (far * np.sqrt(far)))
        return value / a, slope / a**3

    def sum(self, charges: np.ndarray, parts: int, threads: int) -> np.ndarray:
        """The potential of charges, and of the first `parts` - 1 parts of the virial."""
        from scipy import fft
        wave = fft.rfftn(charges, s=self.shape, workers=threads)
        out = fft.irfftn(self.kernels[:parts] * wave, s=self.shape, axes=(1, 2, 3), workers=threads)
        return out[:, :self.count[0], :self.count[1], :self.count[2]]


class MSMTerm(KSpaceTerm):
    """Grids and what leads from one to the next."""

    def __init__(self, solver):
        super().__init__(solver)
        self.constants[0] = solver.own

    def make_kernel(self, level):
        if level == 2 and not self.share_fields.size:
            self.share_fields = np.zeros((7, *self.field.shape))
        return msm.kernel(level, self.solver.order)

    def prepare(self, engine):
        s, nth, half = self.solver, engine.threads, self.solver.order // 2
        self.threads, self.numbers, self.periodic = nth, np.array(s.mesh, np.int64), np.array(s.periodic, np.int64)
        depth = [n.bit_length() for n in s.mesh]
        first, end = -(half - 1) * (1 - self.periodic), self.numbers - 1 + half * (1 - self.periodic)
        self.levels, everywhere = [], bool(s.periodic.all())
        count = max(max(depth) - everywhere, 1)
        for n in range(count):
            points = np.array([2 ** max(k - n - 1, 0) for k in depth])
            if n:
                first = np.where(s.periodic, 0, -((-first + 1) // 2) - (half - 1))
                end = np.where(s.periodic, points - 1, (end + 1) // 2 + half - 1)
            self.levels.append(Level(s, n, points, first, end - first + 1, not everywhere and n == count - 1))
        self.steps = [[self._step(fine, coarse, d) for d in range(3)] for fine, coarse in zip(self.levels, self.levels[1:])]
        finest = self.levels[0].count
        self.wrap = np.zeros((3, int(self.numbers.max()) + s.order), np.int64)
        for d, row in enumerate(self.wrap):
            k = np.arange(len(row))
            row[:] = (k - half + 1) % finest[d] if s.periodic[d] else np.minimum(k, finest[d] - 1)
        self.pieces = np.array([p.coef for p in pieces(s.order)]).T.copy()
        self.held, self.inverse, self.tuned = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
        self.brick, self.density, self.field = np.zeros((nth, *finest)), np.zeros(finest), np.zeros(finest)
        self.share_fields = np.zeros((0, *finest))
        self.base, self.weight = np.zeros((0, 3), np.int64), np.zeros((0, 6 * msm.WIDE))
        self.results, self.with_virial = np.zeros(7), False
        self.grids = [Callback(f) for f in (lambda: self._sum(False), lambda: self._sum(True), lambda: self._sum(True, self.share_fields))]

    def _step(self, fine: Level, coarse: Level, d: int) -> np.ndarray:
        """(coarse points, fine points) weights by which charges go from one grid to the next along a direction; a direction with one point,
        and those beyond a box that is not periodic, stays as it is."""
        ratio, most = fine.points[d] // coarse.points[d], self.solver.order - 1
        nu = np.arange(-most, most + 1)
        weight, out = nodal(self.solver.order, nu / ratio), np.zeros((coarse.count[d], fine.count[d]))
        for row in range(coarse.count[d]):
            at = ratio * (row + coarse.first[d]) + nu - fine.first[d]
            inside = slice(None) if self.solver.periodic[d] else (at >= 0) & (at < fine.count[d])
            np.add.at(out[row], at[inside] % fine.count[d], weight[inside])
        return out

    def _sum(self, energies: bool, shares: np.ndarray | None = None) -> None:
        """From charges on the finest grid to the potential there, down and up the grids."""
        virial = energies or self.with_virial
        if virial > self.with_virial or not np.array_equal(self.tuned, self.held):
            reach = (2.0 * self.solver.cutoff * np.linalg.norm(self.inverse, axis=0) * self.numbers).astype(int)
            for level in self.levels:
                level.tune(self.held, reach, virial)
            self.tuned[:], self.with_virial = self.held, virial
        charges = [self.density]
        for x, y, z in self.steps:
            charges.append(np.einsum("ai,bj,ck,ijk->abc", x, y, z, charges[-1], optimize=True))
        total, above = np.zeros(7), None
        wanted, kept = 7 if energies else 1, 1 if shares is None else 7
        for n in range(len(self.levels) - 1, -1, -1):
            field = self.levels[n].sum(charges[n], wanted, self.threads)
            if energies:
                total += np.einsum("cijk,ijk->c", field, charges[n])
            field = field[:kept]
            if above is not None:
                x, y, z = self.steps[n]
                field = field + np.einsum("ai,bj,ck,dabc->dijk", x, y, z, above, optimize=True)
            above = field
        self.results[:], self.field[:] = total, above[0]
        if shares is not None:
            shares[:] = above

    def make_room(self, slots):
        if len(self.base) < slots:
            self.base, self.weight = np.zeros((slots, 3), np.int64), np.zeros((slots, self.weight.shape[1]))

    def of_solver(self, engine, tid):
        return (self.numbers, self.periodic, self.pieces, self.wrap, self.held, self.inverse, self.brick, self.density, self.field,
                self.share_fields, self.base, self.weight, self.results, self.constants, *(f.address for f in self.grids))
