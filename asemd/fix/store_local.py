"""The internal fix that holds what bond styles store of broken bonds: ``bond_style bpm/spring store/local ID N attributes``.

It is made by the bond style, not by a fix command. Rows are those of the last complete interval of N steps.
Source: LAMMPS manual, bond_style bpm/spring.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import Fix, hook


class StoreLocal(Fix):
    """Rows of the bonds that broke.

    Parameters
    ----------
    use : asemd.forcefield.Use
        The bond style.
    columns : sequence of str
        All that the style remembers of a broken bond, in order; those of its settings are shown.
    """

    minimizes = True

    def __init__(self, use, columns):
        super().__init__()
        self.use, self.columns = use, tuple(columns)
        self.id, self.interval, *self.names = use.settings["store/local"]

    def parameters(self, loop):
        clock = self.use.memory.setdefault("clock", np.zeros(2))
        clock[:] = loop.group_bit(self.group), loop.step
        return clock

    @hook
    def initial_integrate(th, s, p, a):
        if th.tid == 0:
            p[1] = th.step       # all threads meet before the forces

    def local_columns(self):
        return len(self.names) if len(self.names) > 1 else 0

    def local(self, state=None) -> np.ndarray:
        """Values of the attributes, (rows,) or (rows, attributes), up to the last multiple of the interval."""
        rows = self.use.memory.get("broken", np.zeros((0, len(self.columns))))
        step = self.use.memory.get("clock", np.zeros(2))[1]
        end = step - step % self.interval
        rows = rows[(rows[:, 0] > end - self.interval) & (rows[:, 0] <= end)]
        out = rows[:, [self.columns.index(n) for n in self.names]]
        return out if len(self.names) > 1 else out[:, 0]
