r"""A door for one direction: atoms in a region move along one way only.

.. math:: v_d \leftarrow \pm |v_d|

Source: LAMMPS manual, fix oneway. Arguments: N, region, direction ``x``, ``-x``, ``y`` ... ; every N steps, at the end of the step.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.words import choice, exactly, whole

DIRECTIONS = ("x", "y", "z", "-x", "-y", "-z", "+x", "+y", "+z")


class OneWay(Fix):
    """Turn velocities in a region.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two looks.
    region : Region
        Where it acts.
    direction : str
        ``x`` or ``-x`` and so on.

    Raises
    ------
    InputError
        `every` below 1, an unknown direction.
    """

    style = "oneway"

    def __init__(self, group: str = "all", every: int = 1, region=None, direction: str = "x"):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix oneway: N must be at least 1, got {every}")
        choice(direction, DIRECTIONS, "fix oneway direction")
        self.every, self.region, self.direction, self.region_id = every, region, direction, getattr(region, "id", "")

    @classmethod
    def from_lammps(cls, group, words, session):
        every, name, direction = exactly(words, 3, "fix oneway N region direction")
        fix = cls(group, whole(every, "fix oneway N"), session.scene.region(name, "fix oneway"), direction)
        fix.region_id = name
        return fix

    def to_lammps(self) -> list[str]:
        return [str(self.every), self.region_id, self.direction]

    def end_of_step(self, loop) -> None:
        """Turn the velocities that point the wrong way."""
        s, d = loop.state, "xyz".index(self.direction[-1])
        slots = np.flatnonzero(s.mask[:loop.nslots] & np.int64(loop.group_bit(self.group)))
        slots = slots[self.region.inside(s.x[:, slots].T)]
        s.v[d, slots] = np.abs(s.v[d, slots]) * (-1.0 if self.direction[0] == "-" else 1.0)
