r"""Finnis-Sinclair potential: an embedded-atom potential whose densities depend on both elements.

$$E = \sum_i F_i\Big(\sum_{j \neq i} \rho_{ji}(r_{ij})\Big) + \sum_{i<j} \phi_{ij}(r_{ij})$$

Source: LAMMPS manual, pair_style eam; Finnis and Sinclair, Phil. Mag. A 50, 45 (1984).
"""
from __future__ import annotations

from asemd.embedded import Embedded
from asemd.style import register

register(Embedded("eam/fs", doc=__doc__, form={"pairs": True}, example="Fe_mm.eam.fs Fe",
                  see="Finnis and Sinclair, Phil. Mag. A 50, 45 (1984)"))
