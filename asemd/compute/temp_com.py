r"""Temperature after the velocity of the centre of mass of the group has been taken off.

.. math:: T = \frac{\sum_i m_i (\mathbf v_i - \mathbf V)^2}{f k_B}, \qquad \mathbf V = \frac{\sum_i m_i \mathbf v_i}{\sum_i m_i}

Source: LAMMPS manual, compute temp/com. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp


class TempCOM(Temp):
    """Temperature relative to the centre of mass.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    extra_dof : float, optional
        Degrees of freedom to leave out; None is the dimension of the system.
    """

    style = "temp/com"
    bias = True

    def remove_bias(self, state) -> np.ndarray:
        w, v = self._weights(state), state.system.v
        total = w.sum()
        return v - np.einsum("i,ij->j", w, v) / total if total > 0.0 else v
