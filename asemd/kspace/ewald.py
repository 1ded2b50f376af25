r"""Ewald summation: the smooth part of the Coulomb energy as a sum over waves, exact to the accuracy asked for; for small systems.

$$ E = \frac{C}{2 V} \sum_{k \neq 0} \frac{4 \pi}{k^2} e^{-k^2 / 4 g^2} |S(k)|^2 - \frac{C g}{\sqrt{\pi}} \sum_i q_i^2
   - \frac{\pi C}{2 g^2 V} \Big( \sum_i q_i \Big)^2 $$

Waves as LAMMPS chooses them: as many in each direction as the estimate of Kolafa and Perram, Molecular Simulation 9, 351 (1992), wants.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import SimulationError
from asemd.kernels import ewald
from asemd.kspace import MOST, KSpace
from asemd.kspace.term import KSpaceTerm


class Ewald(KSpace):
    """``kspace_style ewald accuracy``."""

    style = flag = "ewald"
    groups = takes_wire = True

    chooser, error = staticmethod(ewald.chooser), staticmethod(ewald.error)

    def choose(self, system):
        given = np.array(self.modify["kmax/ewald"], np.int64)
        self.kmax = given * given.all()       # with one of them 0 LAMMPS chooses all three
        self.tilted = self._tilted(system)
        self.choose_waves(system)

    def choose_waves(self, system) -> None:
        """Waves for the box and the sums over atoms."""
        vectors, self.most = system.box.cell * self.stretch[:, None], np.zeros((2, 3), np.int64)
        if not self.kmax.any():
            self.check_size()
        arguments = vectors, self.kmax, self.g_ewald, self.strength, float(self.n), self.accuracy
        self.waves = self.chooser()(*arguments, np.zeros((0, 3), np.int64), self.most)

    def check_size(self) -> None:
        """Refuse a sum of more waves than any memory holds.

        Raises
        ------
        InputError
            The message says for what.
        """
        most = []
        for length in self.prd:
            n = 1
            while n <= MOST and self.wave_error(n, length) > self.accuracy:
                n *= 2
            most.append(n)
        if max(most) > MOST or math.prod(most) > 2**33:
            raise self.too_large()

    def wave_error(self, waves: int, length: float) -> float:
        """Estimated error of forces of a sum of so many waves along an edge."""
        return self.error(waves, length, self.g_ewald, self.strength, self.n)

    @property
    def strength(self) -> float:
        """What the estimate of the error of the sum takes besides the splitting parameter."""
        return self.q2

    def follow(self, waves: int, most: np.ndarray) -> None:
        """The box takes so many waves now."""
        self.waves, self.most = waves, most.copy()

    def lines(self):
        lpr = math.sqrt(sum(ewald.error(m, length, self.g_ewald, self.q2, self.n) ** 2 for m, length in zip(self.most[1], self.prd)) / 3.0)
        total = math.hypot(lpr, self.real_error)
        most, idle = int(self.most[0].max()), 0
        if self.tilted:     # waves along z that LAMMPS counts and has no phases for
            reach = 1.00001 * max((self.most[1] / self.prd) ** 2)
            idle = sum((n / self.prd[2]) ** 2 <= reach for n in range(self.most[0, 2] + 1, most + 1))
        return ["Ewald initialization ...", "  using polynomial approximation for long-range coulomb",
                f"  G vector (1/distance) = {self.g_ewald:.8g}",
                f"  estimated absolute RMS force accuracy = {total:.8g}",
                f"  estimated relative force accuracy = {total / self.two_charges:.8g}",
                f"  KSpace vectors: actual max1d max3d = {self.waves + idle} {most} {4 * most**3 + 6 * most**2 + 3 * most}",
                f"                  kxmax kymax kzmax  = {' '.join(map(str, self.most[0]))}"]

    def terms(self, engine):
        return [EwaldTerm(self)]


class Waves(KSpaceTerm):
    """A sum over waves, as many as the box takes: a box that grows takes more."""

    held: np.ndarray
    most: np.ndarray

    def make_waves(self, engine, count: int, top: int) -> tuple[int, int]:
        """Room for waves and how many those are, and the largest number along an edge; where the box moves for twice its volume."""
        if engine.box_moves:
            count, top = 2 * count + 64, int(1.3 * top) + 2
        self.numbers, self.waves = np.zeros((count, 3), np.int64), np.zeros((count, 10))
        self.held, self.inverse = np.zeros((4, 3)), np.zeros((3, 3))
        return count, top

    def rebuild(self, engine):
        if self.ready and self.held[3, 2]:
            raise SimulationError(f"kspace_style {self.solver.style}: the box grew so fast that there is no room for the waves it takes; "
                                  "let it grow more slowly")
        if self.ready and engine.box_moves and self.held[3, 1] > 0.7 * len(self.numbers):
            self.solver.follow(int(self.held[3, 1]), self.most)
            self.prepare(engine)
        super().rebuild(engine)


class EwaldTerm(Waves):
    """The sum over waves."""

    make_kernel = staticmethod(ewald.kernel)

    def prepare(self, engine):
        s, nth = self.solver, engine.threads
        m, top = self.make_waves(engine, s.waves, int(s.most[0].max()))
        self.sfac, self.sums, self.most = np.zeros((nth, m, 2)), np.zeros((nth, 8)), np.zeros((2, 3), np.int64)
        self.table = np.zeros((3, 1 + top, 2, 0))
        self.constants = np.append(self.constants[:7], [s.q2, s.n, s.accuracy])

    def count(self, engine):
        super().count(engine)
        self.constants[7:9] = self.solver.q2, self.solver.n

    def make_room(self, slots):
        if self.table.shape[3] < slots:
            self.table = np.zeros((*self.table.shape[:3], slots))

    def of_solver(self, engine, tid):
        return (self.numbers, self.solver.kmax, self.most, self.waves, self.held, self.inverse, self.table, self.sfac, self.sums,
                self.constants)


def choose_waves(engine) -> None:
    """Waves are chosen by the present charges, as in LAMMPS once fixes have acted at the set-up of a run."""
    waves = [t for t in engine.terms if isinstance(t, Waves)]
    if waves:
        engine.solver.choose_waves(engine.system)
        for t in waves:
            t.ready = False
            t.rebuild(engine)
        engine.thread_arguments = None
