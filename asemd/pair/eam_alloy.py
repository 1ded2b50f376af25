r"""Embedded-atom potential of several elements, from a setfl file.

$$E = \sum_i F_i\Big(\sum_{j \neq i} \rho_j(r_{ij})\Big) + \sum_{i<j} \phi_{ij}(r_{ij})$$

F, rho and r phi are tabulated in the file, which also has the masses and the cutoff.

Source: LAMMPS manual, pair_style eam; Daw and Baskes, Phys. Rev. B 29, 6443 (1984).
"""
from __future__ import annotations

from asemd.embedded import Embedded
from asemd.style import register

register(Embedded("eam/alloy", doc=__doc__, example="CuNi.eam.alloy Cu", see="Daw and Baskes, Phys. Rev. B 29, 6443 (1984)"))
