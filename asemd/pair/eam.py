r"""Embedded-atom potential of single elements, from funcfl files.

$$E = \sum_i F_i\Big(\sum_{j \neq i} \rho_j(r_{ij})\Big) + \sum_{i<j} \phi_{ij}(r_{ij}), \qquad
\phi_{ij}(r) = 27.2 \cdot 0.529\, \frac{Z_i(r) Z_j(r)}{r}$$

F, Z and rho are tabulated in one file for each element, ``pair_coeff I I FILE``; pairs of elements are mixed. Masses and the cutoff come
from the file.

Source: LAMMPS manual, pair_style eam; Daw and Baskes, Phys. Rev. B 29, 6443 (1984).
"""
from __future__ import annotations

from asemd.embedded import EmbeddedFuncfl
from asemd.style import register

register(EmbeddedFuncfl("eam", doc=__doc__, example="Cu_u3.eam", see="Daw and Baskes, Phys. Rev. B 29, 6443 (1984)"))
