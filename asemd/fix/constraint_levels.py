r"""Constraints on distances under ``run_style respa``.

After the forces of each level come those that make the next move of the atoms keep the distances. A move is a step of the innermost level;
with the forces of level `l` and those of the levels within it, the next one would lead to

.. math:: x' = x + \Delta t_1 \Big(v + \frac{\Delta t_l}{m} f_l + \sum_{j<l} \frac{\Delta t_j}{2 m} f_j\Big)

So the forces of an outer level correct what the level's own forces would change, and the virial is the sum over the levels.

Source: LAMMPS manual, fix shake and run_style; M. Tuckerman, B. J. Berne, G. J. Martyna, J. Chem. Phys. 97, 1990 (1992).
"""
from __future__ import annotations

import numpy as np

PART, VIRIAL = 1, 8     # places in the numbers of the fix: for which part of the square of the time step its forces act; if virials count


class OnLevels:
    """What fix shake and fix rattle do on levels.

    Attributes
    ----------
    starting : bool
        The forces of a run's start are still to be found: those of half steps.
    """

    levels = "every"
    starting = False

    def on_level(self, loop, level: int) -> None:
        """After the forces of a level."""
        self._hold_on_level(loop, level, self.first_part if self.starting else self.part)
        if level == loop.levels.n:
            loop.state.virial[0] += self.p[VIRIAL] * self.a[3].sum(axis=0)
            self.starting = False

    def _hold_on_level(self, loop, level: int, part: float) -> None:
        """Add to the forces of a level those that keep the distances; `part` of its step is still to come."""
        s, times, before = loop.state, loop._times, self.a[3].copy()
        alone = s._replace(v=loop.next_velocity(level, part), f=np.zeros_like(s.f), virial=np.zeros_like(s.virial))
        self.p[PART] = part * times[level - 1] / times[0]
        loop._call(loop.fixes.index(self), "post_force", alone, times[0])
        self.p[PART] = self.part
        loop._level_forces[level - 1][:3] += alone.f
        if level > 1:
            self.a[3][:] += before

    def _hold_again_on_levels(self, loop) -> None:
        """`hold_again`; as in LAMMPS its virial counts, and until the next step forces are those of the outermost level, not the sum."""
        before = self.a[3].copy()
        for level in range(1, loop.levels.n + 1):
            self._hold_on_level(loop, level, 0.5)
        loop.state.virial[0] += self.p[VIRIAL] * self.a[3].sum(axis=0)
        self.a[3][:] += before
        loop.engine.buffers[0] = loop._level_forces[-1]


__all__ = ["PART", "VIRIAL", "OnLevels"]
