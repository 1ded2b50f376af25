r"""Temperature of the atoms of a group that are in a region now.

The degrees of freedom are those of these atoms, less extra/dof; what constraints take is not counted, as in LAMMPS. Velocities outside the
region are the bias: a thermostat leaves them alone.

Source: LAMMPS manual, compute temp/region. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.words import exactly


class TempRegion(Temp):
    """Temperature in a region.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    region : asemd.region.Region
    """

    style = "temp/region"
    bias = True

    def __init__(self, group: str = "all", region=None):
        super().__init__(group)
        if region is None:
            raise InputError("compute temp/region needs a region")
        self.region = region

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, session.scene.region(exactly(words, 1, "compute temp/region (region-ID)")[0], "compute temp/region"))

    def to_lammps(self) -> list[str]:
        return [self.region.id]

    def _inside(self, state) -> np.ndarray:
        return self.region.inside(state.system.x)

    def dof(self, state) -> float:
        dimension = state.system.dimension
        extra = dimension if self.extra_dof is None else self.extra_dof
        return max(dimension * np.count_nonzero(self._inside(state) & state.groups[self.group]) - extra, 0.0)

    def remove_bias(self, state) -> np.ndarray:
        return np.where(self._inside(state)[:, None], state.system.v, 0.0)
