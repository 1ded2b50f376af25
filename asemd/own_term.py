"""The energy that charges have by themselves in a pair style: constants that belong to its energy and make no forces."""
from __future__ import annotations

import numpy as np

from asemd.errors import SimulationError
from asemd.kernels import own_energy
from asemd.term import Term


class OwnTerm(Term):
    """What `asemd.pairstyle.PairStyle.own_energy` of one pair style gives."""

    category = "pair"

    def __init__(self, owner, numbers: np.ndarray):
        self.owner, self.style, self.tables, self.numbers = owner, owner.style, owner.tables, numbers
        self.factor = np.zeros(1)

    def kernel(self, energy, per_atom):
        return own_energy.of_atoms if per_atom else own_energy.energies if energy else own_energy.nothing

    def rebuild(self, engine):
        self.scale(engine)

    def scale(self, engine) -> None:
        """Take up the present factor of the pair style; one by atom has no energy."""
        self.factor[0] = self.owner.use.factor if np.ndim(self.owner.use.factor) == 0 else 0.0

    def of_charges(self, engine, q: np.ndarray) -> float:
        """The energy that charges q (n,) would have."""
        self.scale(engine)
        acc, n, types = np.zeros(8), len(q), np.ascontiguousarray(engine.system.type, np.int32)
        own_energy.energies(q, types, np.zeros(n, np.int32), 0, n, self.numbers, self.factor, acc, np.zeros(0))
        return float(acc[1])

    def arguments(self, engine, tid):
        s, ns, nth = engine.state, engine.ns, engine.threads
        return (s.q, s.type, s.row, ns * tid // nth, ns * (tid + 1) // nth, self.numbers, self.factor, engine.acc[tid, self.index],
                engine.atom_energy[tid])

    def describe(self, engine, item, value):
        return SimulationError(f"pair style {self.style.name}: the energy of the charges is not finite")


def own_terms(pair_terms, ntypes: int, qqr2e: float) -> list[OwnTerm]:
    """The terms of those pair styles that have such energies, of the atoms whose types they serve."""
    out = []
    for owner in pair_terms:
        numbers = owner.style.own_energy(owner.use.settings, owner.filled, ntypes, qqr2e)
        if numbers is not None:
            full, served = np.tile([0.0, 0.0, 0.0, -np.inf, np.inf], (ntypes + 1, 1)), sorted({t for pair in owner.filled for t in pair})
            full[served, :len(numbers)] = numbers[:, served].T
            out.append(OwnTerm(owner, full))
    return out
