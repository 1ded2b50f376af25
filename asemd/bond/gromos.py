r"""$$E = K (r^2 - r_0^2)^2$$

Bond of the GROMOS force fields, which needs no square root; the usual factor 1/4 is included in K.
Source: LAMMPS manual, bond_style gromos.
"""
from __future__ import annotations

from asemd.style import bond


def gromos_d2(r, K, r0):
    return 4.0 * K * ((r - r0) * (r + r0) + 2.0 * r * r)


@bond("gromos", example="80.0 1.2", equilibrium="r0", d2=gromos_d2)
def gromos(r, K: "energy/distance^4", r0: "distance"):
    d = (r - r0) * (r + r0)
    return K * d * d, 4.0 * K * d * r
