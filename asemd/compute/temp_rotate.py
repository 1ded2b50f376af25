r"""Temperature after the translation and rotation of the group as a whole have been taken off.

.. math:: \mathbf v_{ib} = \mathbf V + \boldsymbol\omega \times (\mathbf r_i - \mathbf R)

with the velocity of the centre of mass and the angular velocity :math:`\boldsymbol\omega = I^{-1} \mathbf L` is the bias; positions are
unwrapped.

Source: LAMMPS manual, compute temp/rotate. Units: temperature; the vector is an energy, as that of `asemd.compute.temp.Temp`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._original import unwrapped
from asemd.compute._pieces import Pieces
from asemd.compute.temp import Temp


class TempRotate(Temp):
    """Temperature without rigid motion.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    extra_dof : float, optional
        Degrees of freedom to leave out; None is the dimension of the system.
    """

    style = "temp/rotate"
    bias = True

    def remove_bias(self, state) -> np.ndarray:
        body = Pieces(state.system, state.mask(self.group))
        return state.system.v - body.vcm - np.cross(body.omega(), unwrapped(state.system) - body.com)
