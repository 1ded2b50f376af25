r"""Forces by finite differences of the energy, to check those of a model.

.. math:: F_{id} = -\frac{E(r_{id} + \delta) - E(r_{id} - \delta)}{2 \delta}

of all interactions, on the atoms of the group; other fixes do not count. Two energies for each direction of each atom: for small systems.

Source: LAMMPS manual, fix numdiff. Arguments: N, the steps between two computations, and delta. Output: three numbers per atom, 0 outside
the group.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.pe import PE
from asemd.errors import InputError
from asemd.fix import Fix
from asemd.words import exactly, number, whole


class NumDiff(Fix):
    """Numerical forces.

    Parameters
    ----------
    group : str
        The atoms whose forces are computed.
    every : int
        Steps between two computations.
    delta : float
        Displacement, distance units of the scene.

    Raises
    ------
    InputError
        `every` below 1, `delta` not positive.
    """

    style = "numdiff"
    brings = ("pe",)
    levels = "every"
    outputs = frozenset({"per_atom"})

    def __init__(self, group: str = "all", every: int = 1, delta: float = 1e-4):
        super().__init__(group)
        if every < 1 or not delta > 0.0:
            raise InputError(f"fix {self.style}: N must be at least 1 and delta positive, got {every} and {delta:g}")
        self.every, self.delta = every, delta
        self.values, self.pe = np.zeros((0, 3)), PE()

    @classmethod
    def from_lammps(cls, group, words, session):
        every, delta = exactly(words, 2, f"fix {cls.style} N delta")
        return cls(group, whole(every, f"fix {cls.style} N"), number(delta, f"fix {cls.style} delta"))

    def to_lammps(self) -> list[str]:
        return [str(self.every), repr(self.delta)]

    def next_step(self, step: int) -> int:
        return (step // self.every + 1) * self.every

    def setup(self, loop) -> None:
        self._differentiate(loop)

    def post_force(self, loop) -> None:
        """Compute them on multiples of N."""
        if loop.step % self.every == 0:
            self._differentiate(loop)

    def _differentiate(self, loop) -> None:
        engine, s = loop.engine, loop.state
        x, f, acc, virial = s.x.copy(), s.f.copy(), engine.acc.copy(), s.virial.copy()
        self.values = np.zeros((loop.system.n, 3))
        for slot in np.flatnonzero(s.mask[:loop.nslots] & np.int64(loop.group_bit(self.group))):
            for d in range(3):
                energies = []
                for sign in (1.0, -1.0):
                    s.x[d, slot] = x[d, slot] + sign * self.delta
                    engine.forces(True)
                    energies.append(float(engine.acc[:, :, :2].sum()))
                s.x[d, slot] = x[d, slot]
                self.values[s.row[slot], d] = -(energies[0] - energies[1]) / (2.0 * self.delta)
        s.f[:], engine.acc[:], s.virial[:] = f, acc, virial

    def per_atom(self, state) -> np.ndarray:
        """(n, 3) the forces, force units."""
        return self.values if len(self.values) == state.system.n else np.zeros((state.system.n, 3))
