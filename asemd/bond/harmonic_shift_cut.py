r"""$$E = \frac{U_{min}}{(r_0 - r_c)^2} \left[ (r - r_0)^2 - (r_c - r_0)^2 \right] \qquad r \le r_c$$

Spring whose energy is $-U_{min}$ at $r_0$, zero at $r_c$ and zero without a force beyond.
Source: LAMMPS manual, bond_style harmonic/shift/cut.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.style import bond


def check(coeff, settings):
    if coeff["r0"] == coeff["rc"]:
        raise InputError(f"bond_coeff harmonic/shift/cut: r0 and rc must be different, both are {coeff['r0']:g}")


def harmonic_shift_cut_d2(r, Umin, r0, rc):
    return 0.0 if r > rc else 2.0 * Umin / ((r0 - rc) * (r0 - rc))


@bond("harmonic/shift/cut", example="10.0 0.8 1.3", check=check, equilibrium="r0", d2=harmonic_shift_cut_d2)
def harmonic_shift_cut(r, Umin: "energy", r0: "distance", rc: "distance"):
    if r > rc:
        return 0.0, 0.0
    K = Umin / ((r0 - rc) * (r0 - rc))
    return K * (r - rc) * ((r - r0) + (rc - r0)), 2.0 * K * (r - r0)
