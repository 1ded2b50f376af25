"""The term of hydrogen bonds, see `asemd.hydrogen_bond`."""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, SimulationError
from asemd.kernels import hydrogen_bond as kernels
from asemd.manybody_term import all_pairs
from asemd.term import Term


class HydrogenBondTerm(Term):
    """Hydrogen bonds of the present list of pairs.

    Attributes
    ----------
    sums : (threads, 2)
        Bonds and their energy at the last evaluation.
    """

    category = "pair"
    start: np.ndarray | None = None

    def __init__(self, owner):
        if np.ndim(owner.use.factor) > 0:
            raise InputError(f"pair_style hybrid/scaled: the factor of {owner.label} cannot differ from atom to atom")
        self.owner, self.style, self.tables = owner, owner.style, owner.tables
        self.found, self.sums, self.weights = np.zeros((5, 64), np.int32), np.zeros((0, 2)), np.ones(5)

    def kernel(self, energy, per_atom):
        return kernels.kernel(self.style.form, energy, per_atom)

    def _hydrogens(self, system) -> None:
        """Partners of each atom in bonds."""
        bonds = system.topology.items("bond")[0]
        a, b = np.concatenate([bonds, bonds[:, ::-1]]).T if len(bonds) else np.zeros((2, 0), np.int32)
        order = np.argsort(a, kind="stable")
        self.start = np.searchsorted(a[order], np.arange(system.n + 1))
        self.partner = np.ascontiguousarray(b[order], np.int64)

    def rebuild(self, engine):
        s = engine.state
        if self.start is None:
            self._hydrogens(engine.system)
        i, j, code, self.shifts, opposite = all_pairs(engine)
        self.params, kind_of = self.tables.arrays
        kind_of = np.where(self.tables.rows[0, :, :, None] > 0.0, kind_of, -1)      # types that neigh_modify excludes have no cutoff
        while True:
            n = kernels.finder()(i, j, code, opposite, s.type, s.row, kind_of, self.start, self.partner, engine.slot_of, self.found)
            if n <= self.found.shape[1]:
                break
            self.found = np.zeros((5, n + n // 8), np.int32)
        self.n = n
        d = s.x[:, self.found[0, :n]] - s.x[:, self.found[2, :n]]
        self.images = np.ascontiguousarray(np.where(engine.periodic, np.rint(d.T @ engine.inverse), 0.0))
        if self.sums.shape[0] != engine.threads:
            self.sums = np.zeros((engine.threads, 2))
        self.scale(engine)

    def scale(self, engine) -> None:
        """Take up the present factor of the pair style."""
        self.weights[:] = self.owner.weights(engine.exclusions.weight_lj, engine.exclusions.weight_coul)[0]

    def arguments(self, engine, tid):
        s, n, nth = engine.state, self.n, engine.threads
        return (s.x, engine.buffers[tid], self.found, self.images, s.box.vectors, self.shifts, self.weights, self.params,
                float(self.style.exact), n * tid // nth, n * (tid + 1) // nth, self.sums[tid], engine.acc[tid, self.index],
                engine.atom_energy[tid], engine.atom_virial[tid], engine.bad[tid, self.index])

    def extra(self) -> np.ndarray:
        """Hydrogen bonds and their energy, (2,)."""
        return self.sums.sum(axis=0)

    def describe(self, engine, item, value):
        ids = [int(engine.system.id[engine.state.row[slot]]) for slot in self.found[:3, int(item)]]
        return SimulationError(f"pair style {self.style.name}: atoms coincide among donor {ids[0]}, acceptor {ids[1]}, hydrogen {ids[2]}")
