r"""Lennard-Jones and Coulomb, each times a switch S(r) that goes from 1 at inner to 0 at outer.

S(r) = (outer^2 - r^2)^2 (outer^2 + 2 r^2 - 3 inner^2) / (outer^2 - inner^2)^3.  epsilon14 and sigma14 (default: epsilon, sigma) are used,
without switch, by dihedral_style charmm for the ends of a dihedral. MacKerell et al., J. Phys. Chem. B 102, 3586 (1998).

Between inner_coul and outer_coul LAMMPS's Coulomb force leaves out the derivative of S, so it is not minus the gradient of LAMMPS's
energy (and energy drifts). Here it is the gradient; ``compat="lammps"`` gives LAMMPS's force.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.coul_cut import coul_cut
from asemd.pair.lj_cut import lj_cut, powers, small_powers
from asemd.pairstyle import PairStyle, make_part, pack_parts, pair_sum


def lj_charmm(r2, epsilon: "energy", sigma: "distance", inner2, outer2, scale):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    es6 = epsilon * s6
    e = 4.0 * es6 * (s6 - 1.0)
    d = -12.0 * es6 * (2.0 * s6 - 1.0) * r2inv
    gap = outer2 - r2
    switch = gap * gap * (outer2 + 2.0 * r2 - 3.0 * inner2) * scale
    slope = 6.0 * gap * (inner2 - r2) * scale
    inside = r2 <= inner2
    return (e if inside else e * switch), (d if inside else d * switch + e * slope)


def coul_charmm(r2, qq, coul_inner2, coul_outer2, coul_scale):
    r2inv = 1.0 / r2
    e = qq * math.sqrt(r2inv)
    d = -0.5 * e * r2inv
    gap = coul_outer2 - r2
    switch = gap * gap * (coul_outer2 + 2.0 * r2 - 3.0 * coul_inner2) * coul_scale
    slope = 6.0 * gap * (coul_inner2 - r2) * coul_scale
    inside = r2 <= coul_inner2
    return (e if inside else e * switch), (d if inside else d * switch + e * slope)


def coul_charmm_lammps(r2, qq, coul_inner2, coul_outer2, coul_scale):
    r2inv = 1.0 / r2
    e = qq * math.sqrt(r2inv)
    gap = coul_outer2 - r2
    switch = gap * gap * (coul_outer2 + 2.0 * r2 - 3.0 * coul_inner2) * coul_scale
    e = e if r2 <= coul_inner2 else e * switch
    return e, -0.5 * e * r2inv


def lj_charmm_d2(r2, epsilon, sigma, inner2, outer2, scale):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e, d = 4.0 * epsilon * s6 * (s6 - 1.0), -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv
    second = 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv
    if r2 <= inner2:
        return second
    gap = outer2 - r2
    switch = gap * gap * (outer2 + 2.0 * r2 - 3.0 * inner2) * scale
    return second * switch + 12.0 * d * gap * (inner2 - r2) * scale + 6.0 * e * (2.0 * r2 - inner2 - outer2) * scale


def coul_charmm_d2(r2, qq, coul_inner2, coul_outer2, coul_scale):
    e = qq / math.sqrt(r2)
    d, second = -0.5 * e / r2, 0.75 * e / (r2 * r2)
    if r2 <= coul_inner2:
        return second
    gap = coul_outer2 - r2
    switch = gap * gap * (coul_outer2 + 2.0 * r2 - 3.0 * coul_inner2) * coul_scale
    return (second * switch + 12.0 * d * gap * (coul_inner2 - r2) * coul_scale
            + 6.0 * e * (2.0 * r2 - coul_inner2 - coul_outer2) * coul_scale)


def lj_charmm_powers(r2, a12, a6, inner2, outer2, scale):
    """`lj_charmm` by the numbers of `powers`; what depends on the settings only is said apart, so that it leaves the loop."""
    width = scale * (outer2 - inner2)
    three, two = 3.0 * width, 2.0 * scale
    r2inv = 1.0 / r2
    r6inv = r2inv * r2inv * r2inv
    gap = outer2 - r2
    inside = r2 <= inner2
    switch = 1.0 if inside else gap * gap * (three - two * gap)
    sixth = 0.0 if inside else gap * (scale * gap - width)      # of the slope of the switch
    force = a12 * r6inv - a6
    energy = force - a6
    return r6inv * energy * switch * (1.0 / 12.0), -0.5 * r6inv * (r2inv * force * switch - energy * sixth)


lj_charmm.powers = {False: ((lj_charmm_powers, powers),), True: ((lj_charmm_powers, small_powers),)}
lj_charmm.d2, coul_charmm.d2 = lj_charmm_d2, coul_charmm_d2


class CharmmPair(PairStyle):
    """Checks the switching distances, derives constants of the switches, and has tables of 1-4 pairs for dihedral_style charmm."""

    one_four_parts = (make_part(lj_cut, "", ("epsilon", "sigma")), make_part(coul_cut, "", ()))

    def parse_settings(self, words):
        if len(words) not in (2, 4):
            raise InputError(f"pair_style {self.name} needs inner outer [inner_coul outer_coul], got {len(words)} values")
        values = super().parse_settings(words)
        for a, b in (("inner", "outer"), ("inner_coul", "outer_coul")):
            if not 0.0 <= values[a] < values[b]:
                raise InputError(f"pair_style {self.name}: {a} = {values[a]:g} must be less than {b} = {values[b]:g} and not negative")
        return values

    def constants(self, settings):
        out = dict(settings)
        for prefix, a, b in (("", "inner", "outer"), ("coul_", "inner_coul", "outer_coul")):
            lo, hi = settings[a], settings[b]
            out |= {prefix + "inner2": lo * lo, prefix + "outer2": hi * hi, prefix + "scale": 1.0 / ((hi - lo) * (hi + lo)) ** 3}
        return out

    def parse_coeff(self, words, settings):
        if len(words) == 3:
            raise InputError(f"pair_coeff {self.name} needs epsilon sigma [epsilon14 sigma14], got 3 values")
        return super().parse_coeff(words, settings)

    def one_four(self, settings, filled, ntypes, units):
        """`PairTables` of `one_four_parts`: epsilon14 and sigma14 of every pair of types, without cutoff."""
        ends = {pair: {"epsilon": c["epsilon14"], "sigma": c["sigma14"]} for pair, c in filled.items()}
        return pack_parts(self.one_four_parts, {}, ends, ntypes, lambda c: (math.inf, math.inf), shift=False)


OPTIONS = dict(
    settings="inner outer [inner_coul] [outer_coul]", coeff="epsilon sigma [epsilon14] [sigma14]",
    defaults={"inner_coul": "inner", "outer_coul": "outer", "epsilon14": "epsilon", "sigma14": "sigma"},
    units={"epsilon14": "energy", "sigma14": "distance"}, mix_rule="arithmetic",
    mix={"epsilon": "sigma", "sigma": "distance", "epsilon14": "sigma14", "sigma14": "distance"},
    settings_example="8.0 10.0 7.0 9.0", example="0.1 3.0 0.05 2.9", see="LAMMPS manual, pair_style lj/charmm/coul/charmm")

style = pair_sum("lj/charmm/coul/charmm", (lj_charmm, "outer"), (coul_charmm, "outer_coul"), cls=CharmmPair, **OPTIONS)
style.twin = CharmmPair("lj/charmm/coul/charmm", [(lj_charmm, "outer"), (coul_charmm_lammps, "outer_coul")], doc=__doc__, **OPTIONS)
