r"""Translational kinetic energy of each atom of a group.

.. math:: E_i = \tfrac{1}{2} m_i v_i^2

Source: LAMMPS manual, compute ke/atom. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute


class KEAtom(Compute):
    """Kinetic energy per atom."""

    style = "ke/atom"

    def per_atom(self, state) -> np.ndarray:
        """(n,) half m v^2; zero outside the group."""
        x, y, z = state.system.v.T
        return np.where(state.mask(self.group), 0.5 * state.units.mvv2e * state.system.atom_masses() * (x * x + y * y + z * z), 0.0)
