r"""Finnis-Sinclair potential for helium in metals: the densities, and so the tables of F, may be negative.

$$E = \sum_i F_i\Big(\sum_{j \neq i} \rho_{ji}(r_{ij})\Big) + \sum_{i<j} \phi_{ij}(r_{ij})$$

The file is one of eam/fs whose line of numbers ends with the largest density; F is linear beyond both ends of its table.

Source: LAMMPS manual, pair_style eam; Zhou, Bartelt and Sills, Phys. Rev. B 103, 014108 (2021).
"""
from __future__ import annotations

from asemd.embedded import Embedded
from asemd.style import register

register(Embedded("eam/he", doc=__doc__, form={"pairs": True, "rhomax": True}, example="PdHHe.eam.he Pd",
                  see="Zhou, Bartelt and Sills, Phys. Rev. B 103, 014108 (2021)"))
