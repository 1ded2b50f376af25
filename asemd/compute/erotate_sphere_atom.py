r"""Rotational energy of each sphere, :math:`\tfrac12 I \omega^2`.

Source: LAMMPS manual, compute erotate/sphere/atom. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute.erotate_sphere import energies


class ErotateSphereAtom(Compute):
    """Rotational energy by atom."""

    style = "erotate/sphere/atom"

    def per_atom(self, state) -> np.ndarray:
        return 0.5 * energies(state, self.group, f"compute {self.style}")
