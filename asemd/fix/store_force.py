"""Keep the force on each atom as it is when this fix acts: fixes that are defined later do not count in it.

Source: LAMMPS manual, fix store/force. Output: values per atom, three columns, force units; zero outside the group.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import Fix, hook


class StoreForce(Fix):
    """Keep the force on each atom before later fixes change it.

    Parameters
    ----------
    group : str
        The atoms whose forces are kept.
    """

    style = "store/force"
    minimizes = True
    levels = "outermost"

    def __init__(self, group: str = "all"):
        super().__init__(group)
        self.data: np.ndarray | None = None

    def atom_arrays(self, loop):
        if self.data is None or len(self.data) != loop.system.n:
            self.data = np.zeros((loop.system.n, 3))
        return self.data

    @hook
    def post_force(th, s, p, a):
        bit, mask, row = np.int32(np.int64(p[0])), s.mask[th.lo:th.hi], s.row[th.lo:th.hi]
        for d in range(3):
            f = s.f[d, th.lo:th.hi]
            for i in range(f.size):
                if row[i] >= 0:
                    a[row[i], d] = f[i] if mask[i] & bit != 0 else 0.0

    def per_atom_columns(self) -> int:
        return 3

    def per_atom(self, state=None) -> np.ndarray:
        """(n, 3) forces."""
        return self.data if self.data is not None else np.zeros((state.system.n if state is not None else 0, 3))
