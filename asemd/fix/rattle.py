r"""Hold bonds and angles at their rest values, and keep velocities free of components along them: RATTLE.

As fix shake (`asemd.fix.shake`, with the same keywords), and at the end of each step

.. math:: r_k \cdot (v_i - v_j) = 0

by changes along the bonds, which are the solution of linear equations. Velocities, and with them kinetic energy and pressure, are then
those of the constrained motion at every step; SHAKE's are so to the order of the integration only. Put this fix after the one that moves
the atoms.

Under ``run_style respa`` velocities are corrected on each level for the half step of that level's forces. LAMMPS takes the outermost step
on all levels: trajectories are the same, for what it leaves along the bonds goes into the forces that keep the distances, but these, and
with them the pressure, are not those of the motion; ``-compat lammps`` does so too.

Source: H. C. Andersen, J. Comput. Phys. 52, 24 (1983); LAMMPS manual, fix rattle.
"""
from __future__ import annotations

import numpy as np

from asemd.fix import hook
from asemd.fix.constraint_levels import PART, VIRIAL
from asemd.fix.constraint_solver import POSITIONS, VELOCITIES, add_virials, hold_positions, hold_velocities
from asemd.fix.shake import Shake

ALL = tuple(dict.fromkeys([*POSITIONS, *VELOCITIES]))


class Rattle(Shake):
    """Constraints on bonds and angles, and on velocities.

    Parameters
    ----------
    group, tolerance, iterations, every, bonds, angles, atoms, masses, spring, settle
        As for `asemd.fix.shake.Shake`.

    Examples
    --------
    >>> Rattle(bonds=[1], angles=[1], tolerance=1e-6)
    """

    style = "rattle"
    verb = "RATTLE"
    part = 0.0

    def setup(self, loop) -> None:
        after = loop.fixes[loop.fixes.index(self) + 1:]
        if any(f.integrates for f in after) and not self.minimizing:
            loop.warn("Fix rattle should come after all other integration fixes")
        super().setup(loop)

    def _prepare_velocities(self, loop, alone) -> None:
        """No velocity along the bonds."""
        s = loop.state
        alone.f[:] = 0.0
        alone.v[:] = s.v
        self.p[1] = 0.0
        loop._call(loop.fixes.index(self), "post_force", alone)
        self.a[3][:] = 0.0
        s.v[:] = alone.v
        loop.sync_out()

    @hook(uses=[*ALL])
    def post_force(th, s, p, a):
        if p[1] == 0.0:
            hold_velocities(th, s, p, a, 0.5 * th.dt)
            add_virials(th, s, p, a, 1.0)       # those of the last step, until the new ones are known
        else:
            hold_positions(th, s, p, a, th.dt, p[1] * th.dt * th.dt)
            add_virials(th, s, p, a, 1.0)
            if th.tid == 0:
                p[1] = 0.0

    @hook(uses=[*ALL])
    def final_integrate(th, s, p, a):
        add_virials(th, s, p, a, -1.0)
        hold_positions(th, s, p, a, th.dt, 0.5 * th.dt * th.dt)
        add_virials(th, s, p, a, 1.0)

    def on_level(self, loop, level: int) -> None:
        """Velocities that, with this level's half step, have no part along the distances."""
        if self.starting:
            super().on_level(loop, level)
            return
        self.p[PART], s = 0.0, loop.state
        alone = s._replace(f=loop._level_forces[level - 1][:3], virial=s.virial if level == loop.levels.n else np.zeros_like(s.virial))
        loop._call(loop.fixes.index(self), "post_force", alone, loop._times[-1 if loop.interactions.compat == "lammps" else level - 1])

    def after_kick(self, loop, level: int) -> None:
        """Forces that keep the distances, after velocities have had theirs of a level."""
        before = self.a[3].copy()       # of the inner levels: that is counted already
        self._hold_on_level(loop, level, 0.5)
        if level == loop.levels.n:
            loop.state.virial[0] += self.p[VIRIAL] * (self.a[3] - before).sum(axis=0)
