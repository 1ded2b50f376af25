r"""Hold bonds and angles at their rest values, and keep velocities free of components along them: RATTLE.

As fix shake (`asemd.fix.shake`, with the same keywords), and at the end of each step

.. math:: r_k \cdot (v_i - v_j) = 0

by changes along the bonds, which are the solution of linear equations. Velocities, and with them kinetic energy and pressure, are then
those of the constrained motion at every step; SHAKE's are so to the order of the integration only. Put this fix after the one that moves
the atoms.

Source: H. C. Andersen, J. Comput. Phys. 52, 24 (1983); LAMMPS manual, fix rattle.
"""
from __future__ import annotations

from asemd.fix import hook
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
            hold_positions(th, s, p, a, th.dt, 0.5 * th.dt * th.dt)
            add_virials(th, s, p, a, 1.0)
            if th.tid == 0:
                p[1] = 0.0

    @hook(uses=[*ALL])
    def final_integrate(th, s, p, a):
        add_virials(th, s, p, a, -1.0)
        hold_positions(th, s, p, a, th.dt, 0.5 * th.dt * th.dt)
        add_virials(th, s, p, a, 1.0)
