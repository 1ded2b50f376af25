r"""Lennard-Jones switched off between inner and outer, as in lj/charmm/coul/charmm, and coul/msm up to cut_coul, for multilevel summation.

epsilon14 and sigma14 (default: epsilon, sigma) are used, without switch, by dihedral_style charmm for the ends of a dihedral.
MacKerell et al., J. Phys. Chem. B 102, 3586 (1998).
"""
from __future__ import annotations

from asemd.pair.coul_msm import coul_msm
from asemd.pair.lj_charmm_coul_charmm import lj_charmm
from asemd.pair.lj_charmm_coul_long import OPTIONS
from asemd.pairstyle import pair_sum

pair_sum("lj/charmm/coul/msm", (lj_charmm, "outer"), (coul_msm, "cut_coul"),
         splits=True, **OPTIONS | {"see": "LAMMPS manual, pair_style lj/charmm/coul/msm"})
