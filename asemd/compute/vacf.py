r"""Velocity autocorrelation of a group: velocities now times those when the compute was made.

.. math:: \langle \mathbf v(0) \cdot \mathbf v(t) \rangle = \frac1N \sum_i \mathbf v_i(0) \cdot \mathbf v_i(t)

Its integral over time is proportional to the diffusion coefficient.

Source: LAMMPS manual, compute vacf. Units: velocity squared. Vector: x, y, z, total.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._original import Original
from asemd.kernels import observe


class VACF(Compute):
    """Velocity autocorrelation."""

    style = "vacf"
    size = 4        # elements of the vector

    def __init__(self, group: str = "all"):
        super().__init__(group)
        self.original: Original | None = None

    @classmethod
    def from_lammps(cls, group, words, session):
        new = super().from_lammps(group, words, session)
        system = session.scene.need_system("compute vacf")
        new.original = Original(system, system.v)
        return new

    def vector(self, state) -> np.ndarray:
        """(4,) mean products along x, y, z and in all."""
        system, mask = state.system, state.mask(self.group)
        if self.original is None:
            self.original = Original(system, system.v)
        products = np.empty(3)
        observe.product(self.original.of(system, system.v), system.v, mask, products)
        products /= max(np.count_nonzero(mask), 1)
        return np.array([*products, products.sum()])
