r"""Temperature without the velocity of a box that fix deform changes: what atoms have beyond the flow.

.. math:: v_i \to v_i - (\dot h\, s_i + \dot r_0)

with fractional coordinates :math:`s_i`, the rates :math:`\dot h` of the box vectors and :math:`\dot r_0` of its origin. Without a fix
deform nothing is taken away.

Source: LAMMPS manual, compute temp/deform. Units: temperature; the tensor is an energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp


class TempDeform(Temp):
    """Temperature beyond the flow of a deforming box."""

    style = "temp/deform"
    bias = True

    def remove_bias(self, state) -> np.ndarray:
        """(n, 3) velocities without the flow."""
        system = state.system
        deform = next((f for f in state.fixes if f.style == "deform"), None)
        if deform is None:
            return system.v
        rates, of_origin = deform.rates
        return system.v - (system.box.fractional(system.x) @ rates + of_origin)
