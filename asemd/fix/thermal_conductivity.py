r"""Exchange kinetic energy between two layers of the box every N steps: the gradient that answers gives the heat conductivity.

The hottest atoms of the first of Nbin layers and the coldest of layer Nbin/2 + 1 exchange their velocities as in an elastic collision,

.. math:: \mathbf v_{1} \leftarrow 2 \mathbf V - \mathbf v_1, \quad \mathbf v_2 \leftarrow 2 \mathbf V - \mathbf v_2, \qquad
          \mathbf V = \frac{m_1 \mathbf v_1 + m_2 \mathbf v_2}{m_1 + m_2}

which keeps momentum and energy.

Source: F. Mueller-Plathe, J. Chem. Phys. 106, 6082 (1997); LAMMPS manual, fix thermal/conductivity. Output: the scalar is the energy
exchanged.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix.exchange import Exchange
from asemd.words import choice, take, whole


class ThermalConductivity(Exchange):
    """Reverse non-equilibrium for the heat conductivity.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two exchanges.
    along : str
        Direction of the layers: ``x``, ``y``, ``z``.
    bins : int
        Number of layers, even.
    swaps : int
        Pairs of atoms in each exchange.

    Raises
    ------
    InputError
        A number that is not positive, an odd number of layers.
    """

    style = "thermal/conductivity"

    def __init__(self, group: str = "all", every: int = 100, along: str = "z", bins: int = 20, swaps: int = 1):
        super().__init__(group, every, "xyz".index(choice(along, "xyz", "fix thermal/conductivity edim")), bins, swaps)

    @classmethod
    def from_lammps(cls, group, words, session):
        every, along, bins = take(words, 3, "fix thermal/conductivity")
        swaps = 1
        if words[3:]:
            if len(words) != 5 or words[3] != "swap":
                raise InputError(f"fix thermal/conductivity: expected swap Nswap after Nbin, got {' '.join(words[3:])}")
            swaps = whole(words[4], "fix thermal/conductivity swap")
        return cls(group, whole(every, "fix thermal/conductivity N"), along, whole(bins, "fix thermal/conductivity Nbin"), swaps)

    def to_lammps(self) -> list[str]:
        return [str(self.every), "xyz"[self.along], str(self.bins), "swap", str(self.swaps)]

    def end_of_step(self, loop) -> None:
        """Exchange kinetic energy."""
        low, middle = self.layers(loop)
        v, mass = loop.system.v, loop.system.atom_masses()
        kinetic = 0.5 * mass * np.einsum("ij,ij->i", v, v)
        hot, cold = self.first(low, -kinetic[low]), self.first(middle, kinetic[middle])
        for i, j in zip(hot, cold):
            common = (mass[i] * v[i] + mass[j] * v[j]) / (mass[i] + mass[j])
            self.exchanged += float(loop.units.mvv2e * (mass[i] * common @ (v[i] - common) - mass[j] * common @ (v[j] - common)))
            v[i], v[j] = 2.0 * common - v[i], 2.0 * common - v[j]
        if len(hot) and len(cold):
            loop.sync_in()
