r"""Lennard-Jones and Coulomb of lj/charmm/coul/charmm with a permittivity that is equal to the distance (in the unit of length).

E = C q_i q_j / (dielectric r^2) S(r) for the Coulomb part, with the switch S of lj/charmm/coul/charmm: a crude picture of solvent.
MacKerell et al., J. Phys. Chem. B 102, 3586 (1998).
"""
from __future__ import annotations

from asemd.pair.lj_charmm_coul_charmm import OPTIONS, CharmmPair, lj_charmm
from asemd.pairstyle import pair_sum


def coul_implicit(r2, qq, coul_inner2, coul_outer2, coul_scale):
    r2inv = 1.0 / r2
    e = qq * r2inv
    d = -e * r2inv
    gap = coul_outer2 - r2
    switch = gap * gap * (coul_outer2 + 2.0 * r2 - 3.0 * coul_inner2) * coul_scale
    slope = 6.0 * gap * (coul_inner2 - r2) * coul_scale
    inside = r2 <= coul_inner2
    return (e if inside else e * switch), (d if inside else d * switch + e * slope)


def coul_implicit_d2(r2, qq, coul_inner2, coul_outer2, coul_scale):
    e = qq / r2
    d, second = -e / r2, 2.0 * e / (r2 * r2)
    if r2 <= coul_inner2:
        return second
    gap = coul_outer2 - r2
    switch = gap * gap * (coul_outer2 + 2.0 * r2 - 3.0 * coul_inner2) * coul_scale
    return (second * switch + 12.0 * d * gap * (coul_inner2 - r2) * coul_scale
            + 6.0 * e * (2.0 * r2 - coul_inner2 - coul_outer2) * coul_scale)


coul_implicit.d2 = coul_implicit_d2
pair_sum("lj/charmm/coul/charmm/implicit", (lj_charmm, "outer"), (coul_implicit, "outer_coul"), cls=CharmmPair,
         **OPTIONS | {"see": "LAMMPS manual, pair_style lj/charmm/coul/charmm/implicit"})
