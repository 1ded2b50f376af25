r"""$$E = 4\epsilon\left[(\sigma/r)^{12} - (\sigma/r)^6\right] + C \left[q_i q_j B_0 + (q_i \vec p_j - q_j \vec p_i) \cdot \vec r B_1
    + \vec p_i \cdot \vec p_j B_1 - (\vec p_i \cdot \vec r)(\vec p_j \cdot \vec r) B_2\right], \qquad B_0 = \frac{\mathrm{erfc}(g r)}{r},
    \quad B_{n+1} = -\frac{B_n'}{r}$$

Lennard-Jones up to cut_lj, and what kspace_style ewald/dipole, or ewald/disp where there are charges, leaves of charges and point dipoles,
up to cut_coul; g is the solver's. One cutoff given means both. Dipoles feel torques. The complementary error function is LAMMPS's
approximation, as in coul/long; special pairs lose the part of their bare energy that special_bonds takes off. Source: Toukmaji, Sagui,
Board, Darden, J. Chem. Phys. 113, 10913 (2000).
"""
from __future__ import annotations

import math

from asemd.pair.coul_long import coul_long
from asemd.pair.lj_cut_dipole_cut import DipolePair
from asemd.style import register


def radial(r2, whole, weight, cut2, constants):
    g = constants[0]
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    x = g * (r2 * rinv)
    gauss = math.exp(-(g * g * r2))
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    bell = 2.0 * g / math.sqrt(math.pi) * gauss
    b0 = tail * rinv
    b1 = (b0 + bell) * r2inv
    bell *= 2.0 * g * g
    b2 = (3.0 * b1 + bell) * r2inv
    bell *= 2.0 * g * g
    b3 = (5.0 * b2 + bell) * r2inv
    less = whole - weight
    c0 = less * rinv
    c1 = c0 * r2inv
    c2 = 3.0 * c1 * r2inv
    b0, b1, b2, b3 = whole * b0 - c0, whole * b1 - c1, whole * b2 - c2, whole * b3 - 5.0 * c2 * r2inv
    return b0, b1, b1, b2, b1, b2, b2, b3


style = register(DipolePair("lj/cut/dipole/long", radial, coul_long, __doc__, coeff="epsilon sigma [cut_lj]", example="0.1 3.0 7.0",
                            units={"g_ewald": "1/distance"}))
style.solvers = frozenset(["ewald/dipole", "ewald/disp", "ewald/disp/dipole"])
