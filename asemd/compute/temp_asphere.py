r"""Temperature of ellipsoids that turn: translation and rotation, or rotation alone.

.. math:: T = \frac{\sum_i m_i v_i^2 + \sum_i L_i \cdot I_i^{-1} L_i}{f k_B}

with the moments of inertia of `asemd.compute.erotate_asphere`. Each ellipsoid has as many degrees of freedom of rotation as the box allows:
three, in two dimensions one; ``compute_modify ID extra/dof N`` corrects that for bodies which no torque turns about one of their axes.
With ``bias ID`` velocities are those without the bias of another compute; with ``dof rotate`` rotation alone counts. The tensor takes
rotation along the axes of each body, as LAMMPS does.

Source: LAMMPS manual, compute temp/asphere. Units: temperature; the tensor is an energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.erotate_asphere import body_rates
from asemd.compute.temp_sphere import TempSphere
from asemd.result import COMPONENTS


class TempAsphere(TempSphere):
    """Temperature of ellipsoids.

    Parameters
    ----------
    group : str
        The atoms it looks at; all need a shape.
    rotation_only, without, extra_dof
        As those of `asemd.compute.temp_sphere.TempSphere`.
    """

    style = "temp/asphere"
    needed = "shape", "a shape", "ellipsoid"

    def turning(self, state) -> int:
        return int(np.count_nonzero(state.groups[self.group]))

    def rotation(self, state) -> np.ndarray:
        inertia, w = body_rates(state, self.group, f"compute {self.style}")
        return state.units.mvv2e * (inertia * w * w).sum(axis=1)

    def rotation_tensor(self, state) -> np.ndarray:
        inertia, w = body_rates(state, self.group, f"compute {self.style}")
        first = (0, 1, 2, 0, 1, 2)      # whose moment goes with each product
        return state.units.mvv2e * np.array([np.einsum("i,i,i->", inertia[:, k], w[:, i], w[:, j])
                                             for k, (i, j) in zip(first, COMPONENTS)])
