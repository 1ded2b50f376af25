r"""$$E = w_{coul} E_{coul}(r) + w_{LJ} E_{LJ}(r)$$

The pair interaction of the two atoms, whatever the pair style is, once more with weights: for 1-5 pairs and the like, which special_bonds
cannot reach. The first number weighs the Coulomb part and the second the rest: that is what LAMMPS computes, though its manual names them
the other way round.
Source: LAMMPS manual, bond_style special.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.style import Parameter, Style, register


class Special(Style):
    def check_scene(self, interactions, system):
        if not interactions.uses["pair"]:
            raise InputError("bond_style special needs a pair style, whose interaction it weighs")
        for k, pairs, keyword, free in ((0, "1-2", "", False), (1, "1-3", "angle", interactions.special_angle),
                                        (2, "1-4", "dihedral", interactions.special_dihedral)):
            want = 1.0 if k else 0.0
            if not free and (interactions.special_lj[k] != want or interactions.special_coul[k] != want):
                raise InputError(f"bond_style special needs special_bonds weights of {want:g} for {pairs} pairs"
                                 + (f", or special_bonds {keyword} yes" if keyword else ""))


special = register(Special("bond", "special", None, coeff=(Parameter("w_coul"), Parameter("w_LJ")), example="0.5 0.5",
                           pair_weights=("w_LJ", "w_coul"), doc=__doc__))
