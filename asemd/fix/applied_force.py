"""What fixes that set or add forces share: three components that may be variables, a region, the total force before they act."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix.formula import Value

if TYPE_CHECKING:
    from asemd.loop import Loop


class AppliedForce(Fix):
    """Base class of setforce and addforce.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    force : sequence of 3 of float or callable or None
        Components in force units; a function of the loop returns one number or one per atom; None leaves a component alone.
    region : Region, optional
        Only atoms inside it.
    """

    minimizes = True
    levels = "one"
    size = 3        # elements of the vector

    def __init__(self, group: str = "all", force: tuple[Value | None, Value | None, Value | None] = (0.0, 0.0, 0.0), region=None):
        super().__init__(group)
        if len(force) != 3:
            raise InputError(f"fix {self.style}: a force has 3 components, got {len(force)}")
        self.force, self.region, self.region_id = tuple(force), region, getattr(region, "id", "")
        self.before = np.zeros(3)
        if region is not None or any(callable(f) for f in force):
            self.post_force = self._with_python

    @staticmethod
    def read_region(words: list[str], what: str, session):
        """The region named by a ``region`` keyword."""
        if not words:
            raise InputError(f"{what}: region needs the ID of a region")
        return session.scene.region(words[0], what)

    def selected(self, loop: Loop) -> np.ndarray:
        """(m,) slots of the atoms it acts on now."""
        s = loop.state
        slots = np.flatnonzero(s.mask[:loop.nslots] & np.int64(loop.group_bit(self.group)))
        return slots if self.region is None else slots[self.region.inside(s.x[:, slots].T)]

    def values(self, loop: Loop, slots: np.ndarray) -> list[np.ndarray | None]:
        """The three components for those slots, (m,) each; None where the force stays."""
        rows = loop.state.row[slots]
        out = []
        for component in self.force:
            value = component(loop) if callable(component) else component
            out.append(None if value is None else np.broadcast_to(value[rows] if np.ndim(value) else value, rows.shape))
        return out

    def vector(self, i: int) -> float:
        """Component `i` (1 to 3) of the total force on the atoms before this fix changed it, force units."""
        if not 1 <= i <= 3:
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 3 components, not {i}")
        return float(self.before[i - 1])
