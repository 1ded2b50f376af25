r"""$$E = K (\chi - \chi_0)^2$$

Spring in the angle between the planes of atoms I, J, K and J, K, L, taken without its sign; the usual factor 1/2 is included in K, which
is per radian squared. Source: LAMMPS manual, improper_style harmonic.
"""
from __future__ import annotations

from asemd.style import improper


def harmonic_d2(chi, K, chi0):
    return 2.0 * K


@improper("harmonic", example="40.0 10.0", equilibrium="chi0", d2=harmonic_d2)
def harmonic(chi, K: "energy", chi0: "angle"):
    d = chi - chi0
    return K * d * d, 2.0 * K * d
