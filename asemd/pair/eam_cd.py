r"""Concentration-dependent embedded-atom potential of two elements A and B, one-site form.

$$E = \sum_i F_i(\rho_i) + \sum_{i<j} h_{ij}\, \phi_{ij}(r_{ij}), \qquad h_{AB} = \tfrac12 (h(x_i) + h(x_j)), \quad h_{AA} = h_{BB} = 1,
\quad x_i = \frac1{\rho_i} \sum_{j \in B} \rho_j(r_{ij})$$

The file is one of eam/alloy that ends with the polynomial h(x). Beyond the largest density of the table F stays as it is.

Source: LAMMPS manual, pair_style eam; Stukowski, Sadigh, Erhart and Caro, Modell. Simul. Mater. Sci. Eng. 17, 075005 (2009).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.embedded import Embedded
from asemd.kernels.embedded import embedding
from asemd.kernels.embedded_concentration import concentration_forces, mixed, polynomial
from asemd.manybody import element_of
from asemd.pairstyle import PairTables
from asemd.style import register


class Concentration(Embedded):
    """Styles eam/cd and eam/cd/old, whose factor of a pair depends on `sites` 1 or 2."""

    coefficients = ()

    def __init__(self, name: str, sites: int, **options):
        super().__init__(name, forces=concentration_forces, helpers=(embedding, polynomial, mixed), shares=4, form={"polynomial": True},
                         example="FeCr.cdeam Fe Cr", see="Stukowski et al., Modell. Simul. Mater. Sci. Eng. 17, 075005 (2009)", **options)
        self.sites = sites

    def read(self, file, elements, settings):
        data = super().read(file, elements, settings)
        data.rhomax = math.inf
        return data

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        made = super().pack_pairs(settings, filled, ntypes, units, shift)
        data = next(iter(filled.values()))["data"]
        second = np.array([float(e == data.elements[1]) for e in element_of(filled, ntypes)])
        return PairTables(made.rows, np.concatenate([made.constants, [self.sites], data.polynomial]), (*made.arrays, second))


register(Concentration("eam/cd", 1, doc=__doc__))
