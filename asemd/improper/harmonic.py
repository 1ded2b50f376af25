r"""$$E = K (\chi - \chi_0)^2$$

Spring in the angle between the planes of atoms I, J, K and J, K, L, taken without its sign; the usual factor 1/2 is included in K, which
is per radian squared. LAMMPS divides by a sine of at least 0.001, so that its forces of groups that are flat within 0.06 degrees are up to
their full size too small; ``compat="lammps"`` gives them. Source: LAMMPS manual, improper_style harmonic.
"""
from __future__ import annotations

import math

from asemd.style import improper


def harmonic_d2(chi, K, chi0):
    return 2.0 * K


def with_smallest_sine(chi, K, chi0):
    d = chi - chi0
    return K * d * d, 2.0 * K * d * min(1.0, math.sin(chi) / 0.001)


@improper("harmonic", example="40.0 10.0", equilibrium="chi0", lammps=with_smallest_sine, d2=harmonic_d2)
def harmonic(chi, K: "energy", chi0: "angle"):
    d = chi - chi0
    return K * d * d, 2.0 * K * d
