r"""$$E = 4\epsilon\left[(\sigma/r)^{12} - (\sigma/r)^6\right] + C \left[\frac{q_i q_j}{r} + \frac{(q_i \vec p_j - q_j \vec p_i) \cdot
    \vec r}{r^3} + \frac{\vec p_i \cdot \vec p_j}{r^3} - \frac{3 (\vec p_i \cdot \vec r)(\vec p_j \cdot \vec r)}{r^5}\right], \qquad
    \vec r = \vec x_i - \vec x_j$$

Lennard-Jones up to cut_lj, charges and point dipoles up to cut_coul; one cutoff given means both. Dipoles feel torques.
Source: M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids (1987).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.coul_cut import coul_cut
from asemd.pair.lj_cut import lj_cut
from asemd.pairstyle import PairStyle
from asemd.style import register


class DipolePair(PairStyle):
    """A pair style of charges with dipoles; `radial` is the function that `asemd.kernels.pair_dipole` asks for."""

    listed = True
    oriented = "dipole"

    def __init__(self, name, radial, charges, doc, plain=lj_cut, **options):
        super().__init__(name, [(plain, "cut_lj"), (charges, "cut_coul")], **{**dict(
            settings="cut_lj [cut_coul]", coeff="epsilon sigma [cut_lj] [cut_coul]", defaults={"cut_coul": "cut_lj"},
            mix={"epsilon": "sigma", "sigma": "distance"}, settings_example="8.0 10.0", example="0.1 3.0 7.0 9.0", doc=doc,
            see=f"LAMMPS manual, pair_style {name}"), **options})
        self.radial = radial

    def check_scene(self, interactions, system):
        if system.q is None or "mu" not in system.extra:
            raise InputError(f"pair style {self.name} needs atoms with charges and dipoles: use atom_style dipole, or hybrid with it")


def radial(r2, whole, weight, cut2, constants):
    r2inv = 1.0 / r2
    b0 = weight * math.sqrt(r2inv)
    b1 = b0 * r2inv
    b2 = 3.0 * b1 * r2inv
    return b0, b1, b1, b2, b1, b2, b2, 5.0 * b2 * r2inv


register(DipolePair("lj/cut/dipole/cut", radial, coul_cut, __doc__))
