r"""$$E = \frac{C}{\epsilon} \sum_{i < j} q_i q_j \left[ \frac{\mathrm{erfc}(\alpha r)}{r} - \frac{\mathrm{erfc}(\alpha r_c)}{r_c} \right]
- \frac{C}{\epsilon} \left[ \frac{\mathrm{erfc}(\alpha r_c)}{2 r_c} + \frac{\alpha}{\sqrt\pi} \right] \sum_i q_i^2$$

Coulomb energy of a neutral surrounding, damped and shifted, instead of a sum over all images. Special pairs lose the part of q_i q_j / r
that special_bonds takes off.  Wolf, Keblinski, Phillpot and Eggebrecht, J. Chem. Phys. 110, 8254 (1999).

LAMMPS also moves the force to zero at the cutoff, so that it is not minus the gradient of LAMMPS's energy. Here it is the gradient;
``compat="lammps"`` gives LAMMPS's force (coul/dsf has the energy that belongs to it).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.pairstyle import PairStyle, pair_sum

ROOT_PI = 1.772453850905516


def bare_special(function):
    """Mark a Coulomb function whose special pairs lose the part of their bare energy that special_bonds takes off."""
    function.long = True
    return function


def bare_listed(function):
    """The same for those special pairs that are not left out, with weights that are not all 0."""
    function.leaves_out = True
    return bare_special(function)


class DampedPair(PairStyle):
    """Derives what the functions need of alpha and the cutoff: ``bell``, and how far energy and force stand from zero at the end."""

    cut_name, level = "cut", "last"

    def constants(self, settings):
        alpha, cut = settings["alpha"], settings[self.cut_name]
        bell = 2.0 * alpha / ROOT_PI
        out = {**settings, "bell": bell}
        if cut > 0.0:
            tail, gauss = math.erfc(alpha * cut), math.exp(-alpha * alpha * cut * cut)
            end = -(tail / cut + bell * gauss) / cut
            out |= {"last": tail / cut, "end": end, "start": tail / cut - end * cut}
        return {"last": 0.0, "end": 0.0, "start": 0.0, **out}

    def own_energy(self, settings, filled, ntypes, qqr2e):
        c = self.constants(settings)
        return np.array([np.zeros(ntypes + 1), np.full(ntypes + 1, -qqr2e * (0.5 * c[self.level] + settings["alpha"] / ROOT_PI))])


class DampedSum(DampedPair):
    """The same beside a Lennard-Jones or Born part."""

    cut_name = "cut_coul"


def coul_wolf_d2(r2, qq, alpha, bell, last):
    r = math.sqrt(r2)
    tail, gauss = math.erfc(alpha * r), math.exp(-alpha * alpha * r2)
    return qq / (4.0 * r2 * r2) * (3.0 * (tail / r + bell * gauss) + 2.0 * alpha * alpha * bell * gauss * r2)


@bare_special
def coul_wolf(r2, qq, alpha: "1/distance", bell, last):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    near = math.erfc(alpha * (r2 * rinv)) * rinv
    return qq * (near - last), -0.5 * qq * (near + bell * math.exp(-alpha * alpha * r2)) * r2inv


@bare_special
def coul_wolf_lammps(r2, qq, alpha: "1/distance", bell, last, end):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    near = math.erfc(alpha * (r2 * rinv)) * rinv
    return qq * (near - last), -0.5 * qq * ((near + bell * math.exp(-alpha * alpha * r2)) * r2inv + end * rinv)


coul_wolf.d2 = coul_wolf_d2
OPTIONS = dict(settings="alpha cut", settings_example="0.2 10.0", see="LAMMPS manual, pair_style coul/wolf")
style = pair_sum("coul/wolf", (coul_wolf, "cut"), cls=DampedPair, **OPTIONS)
style.twin = DampedPair("coul/wolf", [(coul_wolf_lammps, "cut")], doc=__doc__, **OPTIONS)
