r"""$$E = K (r - r_0)^2 \left[ 1 - 2.55 (r - r_0) + \tfrac{7}{12} 2.55^2 (r - r_0)^2 \right]$$

Bond of the MM3 force field; the factor 2.55 is in 1/Angstrom and is converted to the units of the scene.
Source: Allinger, Yuh and Lii, J. Am. Chem. Soc. 111, 8551 (1989); LAMMPS manual, bond_style mm3.
"""
from __future__ import annotations

import numpy as np

from asemd.style import Packed, Parameter, Style, bond

COEFF = (Parameter("K", "energy/distance^2"), Parameter("r0", "distance"))


class MM3(Style):
    """Adds the third and fourth order factors in the units of the scene."""

    def pack(self, settings, coeffs, ntypes, units):
        out = np.zeros((4, ntypes + 1))
        for t, c in coeffs.items():
            out[:, t] = c["K"], c["r0"], -2.55 / units.angstrom, 3.793125 / units.angstrom**2
        return Packed(out)


def mm3_d2(r, K, r0, third, fourth):
    d = r - r0
    return K * (2.0 + d * (6.0 * third + 12.0 * d * fourth))


@bond("mm3", cls=MM3, coeff=COEFF, example="100.0 1.07", equilibrium="r0", d2=mm3_d2)
def mm3(r, K: "energy/distance^2", r0: "distance", third: "1/distance", fourth: "1/distance^2"):
    d = r - r0
    return K * d * d * (1.0 + d * (third + d * fourth)), K * d * (2.0 + d * (3.0 * third + 4.0 * d * fourth))
