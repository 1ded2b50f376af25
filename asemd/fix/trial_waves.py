"""What a long-range solver adds to the energies of trials: each is solved for all atoms anew, as LAMMPS does it with full_energy."""
from __future__ import annotations

import copy
from types import SimpleNamespace

import numpy as np

from asemd.kernels.hooks import bound
from asemd.kernels.state import aligned


def felt(fix, loop) -> bool:
    """Whether the gas of a fix feels the long-range solver of a loop."""
    solver, system, molecule = loop.engine.solver, loop.system, fix.molecule
    if solver is None:
        return False
    charged = (fix.charge or molecule is not None and molecule.q is not None and np.any(molecule.q)
               or system.q is not None and system.q[loop.groups[fix.group]].any() or "mu" in system.extra)
    return bool(charged and solver.coulomb) or getattr(solver, "dispersion", None) is not None


class Waves:
    """The solver's energy of the atoms that are tried.

    Parameters
    ----------
    reservoir : asemd.fix.reservoir.Reservoir
        The solver keeps its parameters; without one that the gas feels all changes are 0.
    """

    def __init__(self, reservoir):
        self.reservoir, self.atoms, loop = reservoir, reservoir.atoms, reservoir.loop
        self.on = felt(reservoir.fix, loop)
        if not self.on:
            return
        self.solver = copy.copy(loop.engine.solver)
        e = self.engine = SimpleNamespace(**vars(loop.engine))       # with other atoms and no terms but those of the solver
        e.terms = self.solver.terms(e)
        for k, t in enumerate(e.terms):
            t.index = k
        e.acc = np.zeros((e.threads, len(e.terms), 8))
        self.capacity = 0
        self.accepted = self.trial = self.energy(*self._without())

    def _without(self, rows=()) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions, types and charges of all atoms but some."""
        a, left = self.atoms, np.ones(self.atoms.n, bool)
        left[list(rows)] = False
        return a.x[:a.n][left], a.type[:a.n][left], a.q[:a.n][left]

    def energy(self, x, types, q) -> float:
        """That of atoms at x (n, 3), energy units."""
        e, n = self.engine, len(x)
        e.system, e.ns = SimpleNamespace(n=n, type=types, q=q), n
        if n > self.capacity:
            self.capacity = -(-(n + n // 8 + 8) // 8) * 8
            e.state = e.state._replace(x=aligned((3, self.capacity)), q=np.zeros(self.capacity), type=np.zeros(self.capacity, np.int32))
            e.buffers = aligned((e.threads, len(e.buffers[0]), self.capacity))
            for t in e.terms:
                t.rebuild(e)
        s = e.state
        s.x[:, :n], s.q[:n], s.type[:n] = x.T, q, types
        self.solver.count(e.system)
        e.acc[:] = 0.0
        calls = []
        for t in e.terms:
            t.count(e)
            calls.append([bound(t.kernel(True, False), t.arguments(e, tid), 1) for tid in range(e.threads)])
        e.parallel(lambda tid: [call[tid]() for call in calls])
        return float(e.acc[:, :, 0].sum())

    def _change(self, x, types, q) -> float:
        self.trial = self.energy(x, types, q)
        return self.trial - self.accepted

    def of_move(self, rows, at) -> float:
        """Change if atoms go to positions (m, 3) in the box, energy units."""
        if not self.on:
            return 0.0
        x, types, q = self._without()
        x = x.copy()
        x[rows] = at
        return self._change(x, types, q)

    def of_insertion(self, at, matrix=None) -> float:
        """Change with one more particle, at positions (m, 3); `matrix`, by which it is turned, tells nothing more."""
        r = self.reservoir
        return self._change(*(np.concatenate(both) for both in zip(self._without(), (at, r.types, r.charges)))) if self.on else 0.0

    def of_deletion(self, rows) -> float:
        """What a deletion gains: the negative change."""
        return -self._change(*self._without(rows)) if self.on else 0.0

    def decided(self, good: bool) -> None:
        """The attempt was accepted or not."""
        if self.on and good:
            self.accepted = self.trial


__all__ = ["Waves", "felt"]
