r"""$$E = K [1 + \cos(n \phi - d)]$$

Torsion of CHARMM beside the pair styles with force switching, lj/charmmfsw/coul/charmmfsh and lj/charmmfsw/coul/long: as dihedral_style
charmm, but the pair interaction of the first and the fourth atom, scaled by w, is shifted like theirs.
Source: MacKerell et al., J. Phys. Chem. B 102, 3586 (1998); Steinbach and Brooks, J. Comput. Chem. 15, 667 (1994); LAMMPS manual,
dihedral_style charmmfsw.
"""
from __future__ import annotations

from asemd.dihedral.charmm import COEFF, Charmm, charmm, charmm_d2, on_line
from asemd.style import register


class CharmmSwitched(Charmm):
    """Takes the shifted 1-4 pairs of the pair style."""

    one_four = "one_four_shifted"
    providers = "lj/charmmfsw/coul/charmmfsh"


charmmfsw = register(CharmmSwitched("dihedral", "charmmfsw", charmm, example="1.2 3 180 0.5", coeff=COEFF, weight_14="w", doc=__doc__,
                                    d2=charmm_d2, straight=on_line))
