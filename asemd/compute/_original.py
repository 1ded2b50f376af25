"""Numbers of atoms as they were, found again by id when atoms come, go or change places."""
from __future__ import annotations

import numpy as np

from asemd.kernels import observe


class Original:
    """Values (n, ...) of the atoms of a system at some time.

    Parameters
    ----------
    system : asemd.system.System
    values : (n, ...) array
    """

    def __init__(self, system, values: np.ndarray):
        self.given, order = system.id.copy(), np.argsort(system.id, kind="stable")
        self.rows = np.array(values)        # by atom row, as long as the atoms are the same
        self.rows.flags.writeable = False
        self.id, self.values = system.id[order], self.rows[order]

    def _places(self, system) -> tuple[np.ndarray, np.ndarray]:
        at = np.minimum(np.searchsorted(self.id, system.id), max(len(self.id) - 1, 0))
        return at, self.id[at] == system.id if len(self.id) else np.zeros(system.n, bool)

    def holds(self, system) -> bool:
        """Whether the atoms are those of then, in the same order: then `rows` are theirs."""
        return system.n == len(self.given) and bool(observe.same(system.id, self.given))

    def of(self, system, fresh: np.ndarray) -> np.ndarray:
        """By atom row now, not to be written to; atoms that were not there then have what `fresh` says."""
        if self.holds(system):
            return self.rows
        at, known = self._places(system)
        out = np.array(fresh)
        out[known] = self.values[at[known]]
        return out

    def update(self, system, values: np.ndarray) -> None:
        """Other values for the atoms of now."""
        self.__init__(system, values)


def unwrapped(system) -> np.ndarray:
    """(n, 3) positions without periodic boundaries."""
    out = np.empty((system.n, 3))
    observe.unwrap(system.x, system.image, system.box.cell, out)
    return out
