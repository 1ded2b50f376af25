r"""Translational kinetic energy of a group.

.. math:: E_k = \tfrac{1}{2} \sum_i m_i v_i^2

Source: LAMMPS manual, compute ke. Units: energy, for the whole group (not per atom).
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute


class KE(Compute):
    """Kinetic energy."""

    style = "ke"

    def scalar(self, state) -> float:
        """Half the sum of m v^2."""
        mask = state.mask(self.group)
        v, mass = state.system.v[mask], state.system.atom_masses()[mask]
        return float(0.5 * state.units.mvv2e * np.einsum("i,ij,ij->", mass, v, v))
