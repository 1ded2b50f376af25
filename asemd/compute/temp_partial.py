r"""Temperature of some components of the velocities; the others are the bias.

.. math:: T = \frac{\sum_i m_i \sum_{d} v_{id}^2}{f k_B}

over the chosen directions d. The degrees of freedom are one for each atom and chosen direction, less those that fixes and extra/dof take,
of which the chosen directions have their share.

Source: LAMMPS manual, compute temp/partial. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp
from asemd.errors import InputError
from asemd.words import exactly, whole


class TempPartial(Temp):
    """Temperature of some directions.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    directions : (bool, bool, bool)
        Whether x, y and z count.

    Raises
    ------
    InputError
        The z direction in two dimensions.
    """

    style = "temp/partial"
    bias = hides = True

    def __init__(self, group: str = "all", directions=(True, True, True)):
        super().__init__(group)
        self.directions = np.array(directions, bool)

    @classmethod
    def from_lammps(cls, group, words, session):
        flags = [whole(w, "compute temp/partial") for w in exactly(words, 3, "compute temp/partial (xflag yflag zflag)")]
        if any(f not in (0, 1) for f in flags):
            raise InputError(f"compute temp/partial: flags must be 0 or 1, got {' '.join(words)}")
        if flags[2] and session.scene.dimension == 2:
            raise InputError("compute temp/partial: zflag must be 0 in a 2d simulation")
        return cls(group, flags)

    def to_lammps(self) -> list[str]:
        return [str(int(d)) for d in self.directions]

    def dof(self, state) -> float:
        return super().dof(state) * np.count_nonzero(self.directions) / state.system.dimension

    def remove_bias(self, state) -> np.ndarray:
        return np.where(self.directions, state.system.v, 0.0)

    def created(self, state, flow: np.ndarray) -> np.ndarray:
        return self.remove_bias(state) + flow      # components it is blind to stay those of before
