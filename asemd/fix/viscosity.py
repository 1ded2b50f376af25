r"""Exchange momentum between two layers of the box every N steps: the flow that answers gives the viscosity (Mueller-Plathe).

In the first of Nbin layers along pdim the atoms whose vdim velocity is positive and closest to vtarget are sought, in layer Nbin/2 + 1
those whose velocity is negative and closest to -vtarget. The pairs exchange this component as in an elastic collision,

.. math:: v_{1} \leftarrow 2 V - v_1, \quad v_2 \leftarrow 2 V - v_2, \qquad V = \frac{m_1 v_1 + m_2 v_2}{m_1 + m_2}

which keeps momentum and energy.

Source: F. Mueller-Plathe, Phys. Rev. E 59, 4894 (1999); LAMMPS manual, fix viscosity. Output: the scalar is the momentum exchanged.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix.exchange import Exchange
from asemd.words import choice, number, take, whole

FAST = 1.0e10       # LAMMPS's INF


class Viscosity(Exchange):
    """Reverse non-equilibrium for the viscosity.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    every : int
        Steps between two exchanges.
    component, along : str
        Component of the momentum, and direction of the layers: ``x``, ``y``, ``z``.
    bins : int
        Number of layers, even.
    swaps : int
        Pairs of atoms in each exchange.
    target : float
        Velocity that is looked for, velocity units; infinite: the fastest.

    Raises
    ------
    InputError
        A number that is not positive, an odd number of layers or fewer than 4.
    """

    style = "viscosity"
    fewest = 4

    def __init__(self, group: str = "all", every: int = 100, component: str = "x", along: str = "z", bins: int = 20, swaps: int = 1,
                 target: float = FAST):
        super().__init__(group, every, "xyz".index(choice(along, "xyz", "fix viscosity pdim")), bins, swaps)
        self.component = "xyz".index(choice(component, "xyz", "fix viscosity vdim"))
        self.target = min(target, FAST)
        if not target > 0.0:
            raise InputError(f"fix viscosity: vtarget must be positive, got {target:g}")

    @classmethod
    def from_lammps(cls, group, words, session):
        every, component, along, bins = take(words, 4, "fix viscosity")
        words, options = words[4:], {}
        while words:
            if words[0] not in ("swap", "vtarget"):
                raise InputError(f"fix viscosity: unknown keyword {words[0]!r}{nearest(words[0], ('swap', 'vtarget'))}")
            value = take(words[1:], 1, f"fix viscosity {words[0]}")[0]
            if words[0] == "swap":
                options["swaps"] = whole(value, "fix viscosity swap")
            else:
                options["target"] = FAST if value == "INF" else number(value, "fix viscosity vtarget")
            words = words[2:]
        return cls(group, whole(every, "fix viscosity N"), component, along, whole(bins, "fix viscosity Nbin"), **options)

    def to_lammps(self) -> list[str]:
        target = "INF" if self.target == FAST else repr(float(self.target))
        return [str(self.every), "xyz"[self.component], "xyz"[self.along], str(self.bins), "swap", str(self.swaps), "vtarget", target]

    def end_of_step(self, loop) -> None:
        """Exchange momentum."""
        low, middle = self.layers(loop)
        v, mass = loop.system.v[:, self.component], loop.system.atom_masses()
        low, middle = low[v[low] >= 0.0], middle[v[middle] <= 0.0]
        ups, downs = self.first(low, np.abs(v[low] - self.target)), self.first(middle, np.abs(v[middle] + self.target))
        for i, j in zip(ups, downs):
            common = (mass[i] * v[i] + mass[j] * v[j]) / (mass[i] + mass[j])
            self.exchanged += float(mass[i] * (common - v[i]) - mass[j] * (common - v[j]))
            v[i], v[j] = 2.0 * common - v[i], 2.0 * common - v[j]
        if len(ups) and len(downs):
            loop.sync_in()
