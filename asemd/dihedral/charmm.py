r"""$$E = K [1 + \cos(n \phi - d)]$$

Torsion of CHARMM and AMBER; d is a whole number of degrees, and w scales the pair interaction of the first and the fourth atom, which
the styles with "charmm" in their name provide. Three atoms on a line have the mean energy K.
Source: MacKerell et al., J. Phys. Chem. B 102, 3586 (1998); LAMMPS manual, dihedral_style charmm.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import Parameter, Style, dihedral


class Charmm(Style):
    """Multiplicity and weight must be in range, and with a weight the rest of the scene must fit.

    `one_four` names the method of pair styles that makes the tables of 1-4 pairs; `providers` are such pair styles.
    """

    one_four = "one_four"
    providers = "lj/charmm/coul/charmm"

    def check(self, coeff, settings):
        command = f"dihedral_coeff {self.name}"
        if coeff["n"] < 0:
            raise InputError(f"{command}: incorrect multiplicity, n must be 0 or more, got {coeff['n']}")
        if not 0.0 <= coeff["w"] <= 1.0:
            raise InputError(f"{command}: incorrect weight, w must be between 0 and 1, got {coeff['w']:g}")

    def needs_pairs(self) -> str:
        """The message for a scene without 1-4 coefficients."""
        return (f"dihedral style {self.name} with a weight that is not 0 needs a pair style with 1-4 coefficients, "
                f"such as {self.providers}")

    def check_scene(self, interactions, system):
        if not any(c["w"] for use in interactions.uses["dihedral"] if use.style is self for c in use.coeff.values()):
            return
        if interactions.special_lj[2] or interactions.special_coul[2]:
            raise InputError(f"dihedral style {self.name} with a weight that is not 0 needs special_bonds charmm: 1-4 factors other than 0 "
                             "would count these pairs twice (weights of 0 belong to force fields such as AMBER)")
        if not any(hasattr(use.style, self.one_four) for use in interactions.uses["pair"]):
            raise InputError(self.needs_pairs())


COEFF = (Parameter("K", "energy"), Parameter("n", "integer"), Parameter("d", "integer"), Parameter("w"))


def charmm_d2(phi, K, n, d):
    return -K * n * n * math.cos(n * phi - math.radians(d))


def on_line(K, n, d):
    return K * (1.0 + math.cos(math.radians(d))) if n == 0.0 else K


@dihedral("charmm", example="1.2 3 180 0.5", cls=Charmm, coeff=COEFF, weight_14="w", d2=charmm_d2, straight=on_line)
def charmm(phi, K: "energy", n: "integer", d: "integer"):
    a = n * phi - math.radians(d)
    c = math.cos(0.5 * a)
    return 2.0 * K * c * c, -K * n * math.sin(a)
