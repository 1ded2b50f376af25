"""A long-range solver as a term of the engine."""
from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

import numpy as np

from asemd.errors import SimulationError
from asemd.kernels.hooks import bound
from asemd.term import Term


def count(engine) -> None:
    """The solver and its terms take the sums over atoms that there are now: charges or types have changed."""
    if engine.solver is not None:
        engine.solver.count(engine.system)
        for t in engine.terms:
            if isinstance(t, KSpaceTerm):
                t.count(engine)


class KSpaceTerm(Term):
    """What the terms of all solvers have in common.

    ``make_kernel(level)`` gives the kernel without energies (0), with energies and virial (1), with the shares of each atom (2). All take
    the same arguments: meeting, thread, x, f, q, the slots of the thread, the box and its origin, what `of_solver` gives, sums of energies
    and virial, shares of energy and of virial.
    """

    category = "kspace"
    of_places = True            # its energy is one of places, charges and types, of nothing else that an atom has
    make_kernel: Callable[[int], Callable]

    def __init__(self, solver):
        self.solver, self.ready = solver, False
        correction = 3.0 if solver.wire else {None: 0.0, "nozforce": solver.nozforce, "ew2d": solver.ew2d}.get(solver.slab, 1.0)
        a, _, c = solver.stretch
        self.constants = np.array([solver.g_ewald, solver.scale * solver.factor, solver.qsum, solver.qsqsum, -a if solver.wire else c,
                                   correction, solver.least])

    def count(self, engine) -> None:
        """Take the solver's sums over atoms as they are now."""
        self.constants[2:4] = self.solver.qsum, self.solver.qsqsum

    def kernel(self, energy, per_atom):
        return self.make_kernel(2 if per_atom else 1 if energy else 0)

    def prepare(self, engine) -> None:
        """Make the arrays, once."""

    def make_room(self, slots: int) -> None:
        """Arrays by slot, for as many of them."""

    def rebuild(self, engine):
        if not self.ready:
            try:
                self.prepare(engine)
            except MemoryError:
                raise self.solver.too_large(getattr(self.solver, "mesh", ())) from None
            self.ready = True
        self.make_room(engine.state.x.shape[1])

    def arguments(self, engine, tid):
        s, ns, nth = engine.state, engine.ns, engine.threads
        return (engine.meeting, tid, s.x, engine.buffers[tid], s.q, ns * tid // nth, ns * (tid + 1) // nth, s.box.vectors,
                s.box.origin, *self.of_solver(engine, tid), engine.acc[tid, self.index], engine.atom_energy[tid], engine.atom_virial[tid])

    @abstractmethod
    def of_solver(self, engine, tid: int) -> tuple:
        """Arguments of this solver's kernels."""

    def set_factor(self, factor: float) -> None:
        """From now on, energies and forces of charges are so many times what they are."""
        self.constants[1] = self.solver.scale * factor

    def of_charges(self, engine, q: np.ndarray, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy, and forces (n, 3), that atoms at x (n, 3) would have with the charges q (n,)."""
        kept, sums, state, slots = (engine.buffers, engine.acc, engine.state), self.constants[2:4].copy(), engine.state, engine.slot_of
        places, charges = state.x.copy(), np.zeros_like(state.q)
        places[:, slots], charges[slots] = x.T, q
        engine.buffers, engine.acc = np.zeros_like(engine.buffers), np.zeros_like(engine.acc)
        engine.state = state._replace(x=places, q=charges)
        self.constants[2:4] = q.sum(), q @ q
        try:
            kernel = self.kernel(True, False)
            calls = [bound(kernel, self.arguments(engine, tid), 1) for tid in range(engine.threads)]
            engine.parallel(lambda tid: calls[tid]())
            return float(engine.acc[:, self.index, 0].sum()), engine.buffers[:, :3, slots].sum(axis=0).T
        finally:
            (engine.buffers, engine.acc, engine.state), self.constants[2:4] = kept, sums

    def describe(self, engine, item, value):
        return SimulationError(f"kspace_style {self.solver.style}: the energy is not finite")
