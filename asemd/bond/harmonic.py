r"""$$E = K (r - r_0)^2$$

Spring between two atoms; the usual factor 1/2 is included in K. Source: LAMMPS manual, bond_style harmonic.
"""
from __future__ import annotations

from asemd.style import bond


def harmonic_d2(r, K, r0):
    return 2.0 * K


@bond("harmonic", example="300.0 1.1", equilibrium="r0", d2=harmonic_d2)
def harmonic(r, K: "energy/distance^2", r0: "distance"):
    dr = r - r0
    return K * dr * dr, 2.0 * K * dr
