"""What the solvers of charges in different media have in common: the kernel of another one, called with several sets of charges."""
from __future__ import annotations

import numpy as np

from asemd.dielectric_term import of_slots
from asemd.errors import InputError
from asemd.kernels.dielectric import around
from asemd.kspace import KSpace
from asemd.kspace.term import KSpaceTerm


class Dielectric(KSpace):
    """Stands before the solver of a homogeneous medium among the bases of a class."""

    groups = takes_wire = False
    partner = "lj/cut/coul/long/dielectric"

    def check(self, system):
        if "epsilon" not in system.extra:
            raise InputError(f"kspace_style {self.style} needs atoms with dielectric constants: use atom_style dielectric")
        super().check(system)


class DielectricTerm(KSpaceTerm):
    """Stands before the term of such a solver among the bases of a class."""

    of_places = False

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.sets = None

    def kernel(self, energy, per_atom):
        level = 2 if per_atom else 1 if energy else 0
        return around(self.make_kernel(level), level)

    def rebuild(self, engine):
        super().rebuild(engine)
        cap, nth = engine.state.x.shape[1], engine.threads
        self.epsilon = of_slots(engine)
        self.charges, self.own_forces, self.own_acc = np.zeros((3, cap)), np.zeros((nth, 3, cap)), np.zeros((nth, 3, 8))
        self.own_energy, self.own_virial = np.zeros((nth, 3, cap)), np.zeros((nth, 3, 6, cap))
        self.sets = [self.constants.copy() for _ in range(3)]
        self.count(engine)

    def count(self, engine):
        super().count(engine)
        system = engine.system
        scaled = system.q / system.extra["epsilon"]
        for constants, q in zip(self.sets, (scaled, system.q, scaled + system.q)):
            constants[2:4] = q.sum(), q @ q

    def set_factor(self, factor):
        super().set_factor(factor)
        for constants in self.sets or ():
            constants[1] = self.constants[1]

    def arguments(self, engine, tid):
        f, q, lo, hi, *_, acc, energy, virial = super().arguments(engine, tid)[3:]
        mean = float(engine.system.extra["epsilon"].mean())
        return (f, q, self.epsilon, lo, hi, mean, self.charges, self.own_forces[tid], self.own_acc[tid], self.own_energy[tid],
                self.own_virial[tid], *(self._of(engine, tid, k) for k in range(3)), acc, energy, virial)

    def _of(self, engine, tid: int, k: int) -> tuple:
        """The solver's arguments for one of the three sets of charges."""
        kept, self.constants = self.constants, self.sets[k]
        meeting, tid, x, _, _, *rest = super().arguments(engine, tid)
        self.constants = kept
        return (meeting, tid, x, self.own_forces[tid], self.charges[k], *rest[:-3], self.own_acc[tid, k], self.own_energy[tid, k],
                self.own_virial[tid, k])
