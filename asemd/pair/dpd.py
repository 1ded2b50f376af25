r"""$$\vec f = \left[ A w - \gamma w^2 (\hat r \cdot \vec v) + \sigma w \zeta / \sqrt{\Delta t} \right] \hat r, \qquad w = 1 - r/r_c,
    \quad \sigma^2 = 2 k_B T \gamma$$

Dissipative particle dynamics: a soft repulsion, and friction and noise along the line of centres, which conserve momentum. The energy is
that of the repulsion, A rc w^2 / 2; zeta is a normal random number for each pair and step. On one thread these numbers are those of
LAMMPS on one processor.  Groot and Warren, J. Chem. Phys. 107, 4423 (1997).
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, PairTables
from asemd.style import register


def repulsion(r, a0: "force", cut: "distance"):
    w = 1.0 - r / cut
    return 0.5 * a0 * cut * w * w, -a0 * w


class NoisyPair(PairStyle):
    """What the styles of this family share."""

    stirred = listed = True
    across = False                           # friction and noise across the line of centres
    temperatures = ("temperature",)

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if not 0 < values["seed"] < 900_000_000:
            raise InputError(f"pair_style {self.name}: seed must be between 1 and 899999999, got {values['seed']}")
        if not values["cut"] > 0.0:
            raise InputError(f"pair_style {self.name}: the cutoff must be more than 0, got {values['cut']:g}")
        for name in self.temperatures:
            if values[name] < 0.0:
                raise InputError(f"pair_style {self.name}: {name} must not be negative, got {values[name]:g}")
        return values

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        rows = np.zeros((8, ntypes + 1, ntypes + 1))
        for (i, j), c in filled.items():
            cut = self.cutoffs(c, settings)[0]
            rows[:, i, j] = rows[:, j, i] = [cut * cut, 0.0, c.get("a0", 0.0), cut, c["gamma"], c.get("gammaT", 0.0), c.get("ws", 1.0),
                                             c.get("wsT", 1.0)]
        return PairTables(rows, np.zeros(0))


UNITS = {"temperature": "temperature", "Tstart": "temperature", "Tstop": "temperature", "seed": "integer", "gamma": "force/velocity",
         "gammaT": "force/velocity", "a0": "force"}

register(NoisyPair("dpd", [(repulsion, "cut")], settings="temperature cut seed", coeff="a0 gamma [cut]", units=UNITS, doc=__doc__,
                   settings_example="1.0 2.5 34387", example="25.0 4.5 2.4", see="LAMMPS manual, pair_style dpd", shifts=False))
