r"""Temperature without the flow that fix accelerate/cos drives, and the amplitude of that flow.

.. math:: V = \frac{2 \sum_i m_i v_{ix} \cos(2 \pi z_i / L_z)}{\sum_i m_i}, \qquad v_{ix} \to v_{ix} - V \cos(2 \pi z_i / L_z)

From the amplitude V comes the viscosity :math:`\eta = \frac{A}{V} \rho \left( \frac{L_z}{2 \pi} \right)^2` with the acceleration A.

Source: B. Hess, J. Chem. Phys. 116, 209 (2002); LAMMPS manual, compute viscosity/cos. Units: temperature; the vector is the kinetic energy
tensor (energy) and the amplitude (velocity).
"""
from __future__ import annotations

import numpy as np

from asemd.compute.temp import Temp


class ViscosityCos(Temp):
    """Temperature beyond a cosine flow in x along z, and its amplitude."""

    style = "viscosity/cos"
    bias = True
    size = 7
    measured: float | None = None       # amplitude when the temperature was last asked for

    def _wave(self, state) -> np.ndarray:
        """(n,) cosine of each atom."""
        box = state.system.box
        return np.cos(2.0 * np.pi * (state.system.x[:, 2] - box.origin[2]) / box.cell[2, 2])

    def amplitude(self, state) -> float:
        """The amplitude of the flow, in velocity units."""
        weights = self._weights(state)
        total = weights.sum()
        return float(2.0 * (weights * state.system.v[:, 0]) @ self._wave(state) / total) if total > 0.0 else 0.0

    def remove_bias(self, state) -> np.ndarray:
        """(n, 3) velocities without the flow, whose amplitude is that of the last temperature: a thermostat leaves out what it measured."""
        if self.measured is None:
            self.measured = self.amplitude(state)
        v = state.system.v.copy()
        v[:, 0] -= self.measured * self._wave(state)
        return v

    def scalar(self, state) -> float:
        """The temperature of what is not flow."""
        self.measured = self.amplitude(state)
        return super().scalar(state)

    def vector(self, state) -> np.ndarray:
        """(7,) sum of m v v without the flow, xx yy zz xy xz yz, and the amplitude of the flow."""
        self.measured = self.amplitude(state)
        return np.append(super().vector(state), self.measured)
