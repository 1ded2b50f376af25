r"""Rotational energy of ellipsoids.

.. math:: E = \tfrac12 \sum_i L_i \cdot I_i^{-1} L_i, \qquad I_{xx} = \tfrac15 m (b^2 + c^2), \; \ldots

with the semi-axes a b c along the axes of each body.

Source: LAMMPS manual, compute erotate/asphere. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.errors import InputError
from asemd.quaternion import axes

INERTIA = 0.05       # of an ellipsoid, per mass and sum of the squares of two diameters


def moments(system) -> np.ndarray:
    """(n, 3) principal moments of inertia; 0 for points."""
    square = system.extra["shape"] ** 2
    return INERTIA * system.atom_masses()[:, None] * (square.sum(axis=1, keepdims=True) - square)


def body_rates(state, group: str, who: str) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) moments of inertia, zero outside the group, and angular velocities along the axes of each body.

    Raises
    ------
    InputError
        Atoms without angular momenta, or a point in the group.
    """
    system, mask = state.system, state.mask(group)
    if "angmom" not in system.extra:
        raise InputError(f"{who} needs ellipsoids: use atom_style ellipsoid, or hybrid with it")
    points = mask & (system.extra["shape"][:, 0] == 0.0)
    if points.any():
        raise InputError(f"{who}: atom {system.id[points].min()} is a point, all atoms of the group need a shape")
    inertia = np.where(mask[:, None], moments(system), 0.0)
    along = np.einsum("nka,na->nk", axes(system.extra["quaternions"]), system.extra["angmom"])
    return inertia, np.divide(along, inertia, out=np.zeros_like(along), where=inertia > 0.0)


class ErotateAsphere(Compute):
    """Rotational energy of the ellipsoids of a group."""

    style = "erotate/asphere"
    extensive = True

    def scalar(self, state) -> float:
        inertia, w = body_rates(state, self.group, f"compute {self.style}")
        return 0.5 * state.units.mvv2e * float((inertia * w * w).sum())
