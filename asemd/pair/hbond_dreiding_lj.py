r"""$$E = \epsilon \left[ 5 \left( \frac{\sigma}{r} \right)^{12} - 6 \left( \frac{\sigma}{r} \right)^{10} \right] \cos^n \theta$$

Hydrogen bonds of DREIDING: r is the distance of donor and acceptor, theta the angle donor-hydrogen-acceptor, for every hydrogen atom bonded
to the donor. Between the inner and the outer cutoff the energy is switched off; below the angle cutoff there is none.

LAMMPS's force between the cutoffs is not minus the gradient of its energy: the change of the switch lacks the power of the cosine. Here it
is the gradient; ``compat="lammps"`` gives LAMMPS's force. Source: S. L. Mayo, B. D. Olafson, W. A. Goddard, J. Phys. Chem. 94, 8897 (1990).
"""
from __future__ import annotations

from asemd.hydrogen_bond import hydrogen_bond


@hydrogen_bond("hbond/dreiding/lj", "epsilon sigma", units={"epsilon": "energy", "sigma": "distance"}, settings_example="4 9.0 11.0 90.0",
               example="2 i 4.0 2.75 4 8.0 9.5 85.0", see="LAMMPS manual, pair_style hbond/dreiding/lj")
def twelve_ten(r2, p):
    u = p[8] * p[8] / r2
    u5 = u * u * u * u * u
    return p[7] * u5 * (5.0 * u - 6.0), -30.0 * p[7] * u5 * (u - 1.0) / r2
