"""Terms of charges of which each stands in a medium of its own: atom style dielectric."""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.kernels import pair_dielectric, pair_sums
from asemd.kernels.generate import Builder
from asemd.kernels.pair import paste_one
from asemd.term import PairListTerm


@cache
def kernel(style, energy: bool, per_atom: bool):
    """The kernel of `asemd.kernels.pair_dielectric` for a style."""
    b = Builder(f"pair {style.name}: charges in different media")
    b.line("real = np.float64")
    b.constant("ENERGY", energy)
    b.constant("PER_ATOM", per_atom)
    b.constant("LONG", bool(style.solvers))
    paste_one(b, style, style.parts, apart=True)
    pair_sums.use(b, "eight", "add")
    b.function(pair_dielectric.dielectric_forces)
    return b.build().dielectric_forces


def of_slots(engine) -> np.ndarray:
    """Dielectric constants where the atoms are, by slot; 1 for empty ones."""
    row = engine.state.row
    return np.where(row >= 0, engine.system.extra["epsilon"][row], 1.0)


class DielectricPairTerm(PairListTerm):
    """All pairs of the list.

    Raises
    ------
    InputError
        The style has a factor for each atom.
    """

    def __init__(self, owner):
        super().__init__(owner.style, owner.tables, owner.style.parts, "all", owner=owner)
        if self.by_atom:
            raise InputError(f"pair style {self.style.name} cannot have a factor for each atom")

    def kernel(self, energy, per_atom):
        return kernel(self.style, energy, per_atom)

    def rebuild(self, engine):
        super().rebuild(engine)
        self.epsilon = of_slots(engine)

    def arguments(self, engine, tid):
        s, m, nth = engine.state, len(self.i), engine.threads
        return (s.x, engine.buffers[tid], s.q, self.epsilon, s.type, self.i, self.j, self.code, self.shifts, self.lj, self.coul,
                m * tid // nth, m * (tid + 1) // nth, self.tables.rows, self.tables.constants, self.tables.arrays, engine.qqr2e,
                engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid], engine.bad[tid, self.index])
