"""The internal fix of ``group ID dynamic``: chooses the members of a group anew, every so many steps.

It is made by the group command, not by a fix command. Members are those atoms of the parent group that are in the region and for which the
variable and the property are not zero, at the start of a run and after each move of the atoms.
Source: LAMMPS manual, group.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix


class DynamicGroup(Fix):
    """Members of a group that change.

    Parameters
    ----------
    name, parent : str
        The group, and the one its members are taken from.
    session : asemd.lammps.session.Session
        Knows regions and variables.
    region, variable, vector : str, optional
        Names of a region, an atom-style variable and a property of atoms such as ``i_flag``.
    every : int
    """

    levels = "every"

    def __init__(self, name: str, parent: str, session, region: str | None = None, variable: str | None = None, vector: str | None = None,
                 every: int = 1):
        super().__init__(parent)
        self.id, self.name, self.session = f"GROUP_{name}", name, session
        self.region, self.variable, self.property, self.every = region, variable, vector, every

    def members(self) -> np.ndarray:
        """Who belongs to the group now: (n,) bool array.

        Raises
        ------
        InputError
            A region or variable that is gone.
        """
        scene, what = self.session.scene, f"group {self.name} dynamic"
        system = scene.system
        mask = scene.groups.mask(self.group, what).copy()
        if self.region is not None:
            mask &= scene.region(self.region, what).inside(system.x)
        if self.variable is not None:
            mask &= self.session.variables.per_atom(self.variable, system.n) != 0.0
        if self.property is not None:
            if self.property not in system.extra:
                raise InputError(f"{what}: atoms have no property {self.property}")
            mask &= np.asarray(system.extra[self.property]).reshape(system.n) != 0
        return mask

    def setup(self, loop):
        self.choose(loop)

    def post_integrate(self, loop):
        if loop.step % self.every == 0:
            loop.sync_out()
            self.session.look(loop)
            self.choose(loop)

    def choose(self, loop) -> None:
        """Set the group, here and in the loop."""
        before = loop.groups[self.name]
        loop.groups[self.name] = self.members()
        engine, state = loop.engine, loop.state
        engine.set_groups(loop.groups, engine.bits)
        slots = np.flatnonzero(state.row >= 0)
        state.mask[slots] = engine.mask_row[state.row[slots]]
        if loop.step > loop.begin and not np.array_equal(before, loop.groups[self.name]):
            for fix in loop.fixes:      # degrees of freedom
                fix.resize(loop)
