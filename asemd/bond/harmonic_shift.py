r"""$$E = \frac{U_{min}}{(r_0 - r_c)^2} \left[ (r - r_0)^2 - (r_c - r_0)^2 \right]$$

Spring whose energy is $-U_{min}$ at $r_0$ and zero at $r_c$. Source: LAMMPS manual, bond_style harmonic/shift.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.style import bond


def check(coeff, settings):
    if coeff["r0"] == coeff["rc"]:
        raise InputError(f"bond_coeff harmonic/shift: r0 and rc must be different, both are {coeff['r0']:g}")


def harmonic_shift_d2(r, Umin, r0, rc):
    return 2.0 * Umin / ((r0 - rc) * (r0 - rc))


@bond("harmonic/shift", example="10.0 0.8 1.3", check=check, equilibrium="r0", d2=harmonic_shift_d2)
def harmonic_shift(r, Umin: "energy", r0: "distance", rc: "distance"):
    K = Umin / ((r0 - rc) * (r0 - rc))
    return K * (r - rc) * ((r - r0) + (rc - r0)), 2.0 * K * (r - r0)
