"""The internal fix of ``group ID dynamic``: chooses the members of a group anew, every so many steps.

It is made by the group command, not by a fix command. Members are those atoms of the parent group that are in the region and for which the
variable and the property are not zero, at the start of a run and after each move of the atoms
and whatever joins or leaves with it.
Source: LAMMPS manual, group.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.kernels import rows


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

    def next_step(self, step: int) -> int:
        return (step // self.every + 1) * self.every

    def setup(self, loop):
        self.choose(loop, False)

    def post_integrate(self, loop):
        """Under ``run_style respa``, after each of the innermost moves of its steps."""
        if hasattr(loop, "levels") and loop.step % self.every == 0:
            self.choose(loop)

    def pre_force(self, loop):
        """On its steps, when atoms have come and gone."""
        if not hasattr(loop, "levels"):
            self.choose(loop)

    def choose(self, loop, moved: bool = True) -> None:
        """Set the group, here and in the loop; `moved`: the system and what formulas see are not of this step yet."""
        engine, s, slots = loop.engine, loop.state, loop.nslots
        region = None if self.region is None else self.session.scene.region(self.region, f"group {self.name} dynamic")
        if region is not None and not region.varies and self.variable is None and self.property is None:
            parent, chosen = self.session.scene.groups.mask(self.group, f"group {self.name} dynamic"), region.inside(s.x.T)[:slots]
        else:
            if moved:
                loop.sync_out()
                self.session.look(loop)
            parent = self.members()
            chosen = np.ones(slots, bool)
        members = np.zeros(len(parent), bool)
        before = loop.groups[self.name]
        differ = rows.regroup(s.row, chosen, parent, np.int32(loop.group_bit(self.name)), engine.mask_row, s.mask, members)
        loop.groups[self.name] = engine.groups[self.name] = members
        engine.varies[3] = differ        # masks
        if loop.step > loop.begin and not np.array_equal(before, members):
            for fix in loop.fixes:      # degrees of freedom
                fix.resize(loop)
