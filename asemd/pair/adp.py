r"""Angular-dependent potential: an embedded-atom potential with dipoles and quadrupoles of the surroundings.

$$E = \sum_i F_i(\rho_i) + \sum_{i<j} \phi_{ij}(r_{ij}) + \frac12 \sum_i \Big(|\mu_i|^2 + \lambda_i : \lambda_i - \tfrac13 \nu_i^2\Big)$$
$$\mu_i = \sum_j u_{ij}(r_{ij})\, \mathbf r_{ij}, \quad \lambda_i = \sum_j w_{ij}(r_{ij})\, \mathbf r_{ij} \mathbf r_{ij}, \quad
\nu_i = \mathrm{tr}\, \lambda_i$$

The file is one of eam/alloy that ends with u and w of each pair of elements.

Source: LAMMPS manual, pair_style adp; Mishin, Mehl and Papaconstantopoulos, Acta Mater. 53, 4029 (2005).
"""
from __future__ import annotations

from asemd.embedded import Embedded
from asemd.kernels.embedded import embedding
from asemd.kernels.embedded_angular import angular_forces
from asemd.style import register


class Angular(Embedded):
    """Style adp."""

    coefficients = ()

    def further(self, data, factor):
        # the energies are squares of these functions
        return tuple({pair: factor**0.5 * values for pair, values in table.items()} for table in (data.u, data.w))


register(Angular("adp", doc=__doc__, forces=angular_forces, helpers=(embedding,), shares=10, form={"angular": True},
                 example="Ni.adp Ni", see="Mishin, Mehl and Papaconstantopoulos, Acta Mater. 53, 4029 (2005)"))
