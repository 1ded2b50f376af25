r"""Rotational energy of spheres.

.. math:: E = \tfrac12 \sum_i I_i \omega_i^2, \qquad I = \tfrac25 m R^2

Source: LAMMPS manual, compute erotate/sphere. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError

INERTIA = 0.4       # of a sphere, per mass and radius squared


def energies(state, group: str, who: str) -> np.ndarray:
    """(n,) twice the rotational energy of each atom, zero outside the group.

    Raises
    ------
    InputError
        Atoms without angular velocities.
    """
    system = state.system
    if "omega" not in system.extra:
        raise InputError(f"{who} needs atoms with angular velocities: use atom_style sphere, or hybrid with it")
    inertia = INERTIA * system.atom_masses() * system.extra["radius"] ** 2
    return np.where(state.mask(group), state.units.mvv2e * inertia * (system.extra["omega"] ** 2).sum(axis=1), 0.0)


class ErotateSphere(Compute):
    """Rotational energy of the spheres of a group."""

    style = "erotate/sphere"
    extensive = True

    def scalar(self, state) -> float:
        return 0.5 * float(energies(state, self.group, f"compute {self.style}").sum())
