r"""$$E = K [1 + \cos(n \phi - d)]$$

Torsion of CHARMM and AMBER; d is a whole number of degrees, and w scales the pair interaction of the first and the fourth atom, which
the styles with "charmm" in their name provide.
Source: MacKerell et al., J. Phys. Chem. B 102, 3586 (1998); LAMMPS manual, dihedral_style charmm.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import Parameter, Style, dihedral


class Charmm(Style):
    """Refuses multiplicities and weights out of range; `one_four` is the method of the pair style that makes the tables of 1-4 pairs."""

    one_four = "one_four"

    def check(self, coeff, settings):
        command = f"dihedral_coeff {self.name}"
        if coeff["n"] < 0:
            raise InputError(f"{command}: incorrect multiplicity, n must be 0 or more, got {coeff['n']}")
        if not 0.0 <= coeff["w"] <= 1.0:
            raise InputError(f"{command}: incorrect weight, w must be between 0 and 1, got {coeff['w']:g}")


COEFF = (Parameter("K", "energy"), Parameter("n", "integer"), Parameter("d", "integer"), Parameter("w"))


@dihedral("charmm", example="1.2 3 180 0.5", cls=Charmm, coeff=COEFF, weight_14="w")
def charmm(phi, K: "energy", n: "integer", d: "integer"):
    a = n * phi - math.radians(d)
    c = math.cos(0.5 * a)
    return 2.0 * K * c * c, -K * n * math.sin(a)
