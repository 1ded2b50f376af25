r"""$$E = K_2 (r - r_0)^2 + K_3 (r - r_0)^3 + K_4 (r - r_0)^4$$

Bond of the class 2 force fields (CFF, COMPASS): the softening of a stretched bond up to fourth order.
Source: Sun, J. Phys. Chem. B 102, 7338 (1998); LAMMPS manual, bond_style class2.
"""
from __future__ import annotations

from asemd.style import bond


def class2_d2(r, r0, K2, K3, K4):
    d = r - r0
    return 2.0 * K2 + d * (6.0 * K3 + 12.0 * d * K4)


@bond("class2", example="1.1 300.0 -500.0 700.0", equilibrium="r0", d2=class2_d2)
def class2(r, r0: "distance", K2: "energy/distance^2", K3: "energy/distance^3", K4: "energy/distance^4"):
    d = r - r0
    return d * d * (K2 + d * (K3 + d * K4)), d * (2.0 * K2 + d * (3.0 * K3 + 4.0 * d * K4))
