r"""Set components of the force on atoms.

.. math:: F_i \leftarrow (f_x, f_y, f_z)

A component NULL (None) stays as it is. Zero holds atoms still if they have no velocity. It acts in minimisation as well.

Source: LAMMPS manual, fix setforce. Units: force. Output: a vector of 3, the total force on the group before.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.applied_force import AppliedForce
from asemd.fix.formula import read, write
from asemd.kernels.threads import reduce_sum


class SetForce(AppliedForce):
    """Set the force.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    force : sequence of 3 of float or callable or None
        Components in force units of the scene; None leaves a component alone; a function of the loop returns one number or one per atom.
    region : Region, optional
        Only atoms inside it.
    """

    style = "setforce"

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) < 3:
            raise InputError(f"fix setforce needs fx fy fz, got {len(words)} values")
        force = [None if w == "NULL" else read(w, "fix setforce force", session) for w in words[:3]]
        region, words = None, words[3:]
        while words:
            if words[0] != "region":
                raise InputError(f"fix setforce: unknown keyword {words[0]!r}{nearest(words[0], ('region',))}")
            region = cls.read_region(words[1:], "fix setforce", session)
            name, words = words[1], words[2:]
        fix = cls(group, force, region)
        if region is not None:
            fix.region_id = name
        return fix

    def to_lammps(self) -> list[str]:
        return [write(f) for f in self.force] + (["region", self.region_id] if self.region is not None else [])

    def parameters(self, loop) -> np.ndarray:
        force = [0.0 if f is None or callable(f) else f for f in self.force]
        p = np.array([loop.group_bit(self.group), *force, *(f is not None for f in self.force), *self.before], dtype=float)
        self.before = p[7:]
        return p

    @hook
    def post_force(th, s, p, a):
        bit, mask = np.int32(np.int64(p[0])), s.mask[th.lo:th.hi]
        for d in range(3):
            f, value, change, before = s.f[d, th.lo:th.hi], p[1 + d], p[4 + d] != 0.0, 0.0
            for i in range(f.size):
                if mask[i] & bit != 0:
                    before += f[i]
                    f[i] = value if change else f[i]
            before = reduce_sum(th, before)
            if th.tid == 0:
                p[7 + d] = before

    def elsewhere(self, loop) -> np.ndarray:
        """What it does on the other levels of ``run_style respa``: no force in the components it sets. Returns the total force before."""
        slots, f = self.selected(loop), loop.state.f
        before = f[:, slots].sum(axis=1)
        for d, value in enumerate(self.force):
            if value is not None:
                f[d, slots] = 0.0
        return before

    def _with_python(self, loop) -> None:
        slots, f = self.selected(loop), loop.state.f
        self.before[:] = f[:, slots].sum(axis=1)
        for d, value in enumerate(self.values(loop, slots)):
            if value is not None:
                f[d, slots] = value
