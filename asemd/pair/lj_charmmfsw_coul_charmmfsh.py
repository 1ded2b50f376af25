r"""$$E = 4\epsilon \left[ \sigma^{12} \frac{R^6}{R^6 - a^6} \left(\frac{1}{r^6} - \frac{1}{R^6}\right)^2
    - \sigma^6 \frac{R^3}{R^3 - a^3} \left(\frac{1}{r^3} - \frac{1}{R^3}\right)^2 \right]
    + C q_i q_j \frac{(r_c - r)^2}{r \, r_c^2} \qquad a < r < R$$

Lennard-Jones whose force is switched off between inner (a) and outer (R), and Coulomb with shifted force; below a the Lennard-Jones
energy is 4 epsilon [(sigma/r)^12 - sigma^12 / (a R)^6 - (sigma/r)^6 + sigma^6 / (a R)^3]. epsilon14 and sigma14 (default: epsilon,
sigma) are used for the ends of a dihedral: without any switch by dihedral_style charmm, with the expressions of short distances by
charmmfsw. In units real the Coulomb constant is CHARMM's, 332.0716, for all interactions.

Between inner and outer LAMMPS's Lennard-Jones force is that of the plain potential times the switch of lj/charmm/coul/charmm, which is not
minus the gradient of LAMMPS's energy. Here it is the gradient; ``compat="lammps"`` gives LAMMPS's force.
Source: Steinbach and Brooks, J. Comput. Chem. 15, 667 (1994); LAMMPS manual, pair_style lj/charmmfsw/coul/charmmfsh.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pair.coul_cut import coul_cut
from asemd.pair.lj_cut import lj_cut
from asemd.pairstyle import PairStyle, make_part, pack_parts, pair_sum


def lj_shifted(r2, epsilon: "energy", sigma: "distance", shift12, shift6):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    sigma3 = sigma * sigma * sigma
    sigma6 = sigma3 * sigma3
    e = s6 * s6 - sigma6 * sigma6 * shift12 - s6 + sigma6 * shift6
    return 4.0 * epsilon * e, -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv


def lj_charmmfsw(r2, epsilon: "energy", sigma: "distance", shift12, shift6, inner2, outer, factor12, factor6):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    sigma3 = sigma * sigma * sigma
    sigma6 = sigma3 * sigma3
    rinv = math.sqrt(r2inv)
    gap = (outer - r2 * rinv) / outer * rinv                   # 1/r - 1/R
    far = 1.0 / outer
    near = gap * (r2inv + rinv * far + far * far)              # 1/r^3 - 1/R^3
    sum3 = r2inv * rinv + far * far * far
    repulsion = factor12 * sigma6 * sigma6 * near * sum3
    attraction = factor6 * sigma6 * near
    switched = 4.0 * epsilon * (repulsion * near * sum3 - attraction * near)
    r5inv = r2inv * r2inv * rinv
    slope = -12.0 * epsilon * r5inv * (2.0 * repulsion * r2inv * rinv - attraction)
    e = 4.0 * epsilon * (s6 * s6 - sigma6 * sigma6 * shift12 - s6 + sigma6 * shift6)
    d = -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv
    inside = r2 <= inner2
    return (e if inside else switched), (d if inside else slope)


def lj_charmmfsw_lammps(r2, epsilon: "energy", sigma: "distance", shift12, shift6, inner2, outer, factor12, factor6):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    sigma3 = sigma * sigma * sigma
    sigma6 = sigma3 * sigma3
    far3 = 1.0 / (outer * outer * outer)
    near3 = r2inv * math.sqrt(r2inv)
    a, b = (near3 - far3) * (near3 + far3), near3 - far3
    e = 4.0 * epsilon * (s6 * s6 - sigma6 * sigma6 * shift12 - s6 + sigma6 * shift6)
    switched = 4.0 * epsilon * sigma6 * (factor12 * sigma6 * a * a - factor6 * b * b)
    d = -12.0 * epsilon * s6 * (2.0 * s6 - 1.0) * r2inv
    gap, width = (outer * outer - r2), (outer * outer - inner2)
    slope = d * gap * gap * (outer * outer + 2.0 * r2 - 3.0 * inner2) / (width * width * width)
    inside = r2 <= inner2
    return (e if inside else switched), (d if inside else slope)


def coul_charmmfsh(r2, qq, cut_coul):
    r = math.sqrt(r2)
    rest = (cut_coul - r) / cut_coul
    c = qq / r
    return c * rest * rest, -0.5 * c * rest * (1.0 + r / cut_coul) / r2


def lj_charmmfsw_d2(r2, epsilon, sigma, shift12, shift6, inner2, outer, factor12, factor6):
    s6 = (sigma * sigma / r2) ** 3
    if r2 <= inner2:
        return 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) / (r2 * r2)
    far3, near3 = 1.0 / (outer * outer * outer), 1.0 / (r2 * math.sqrt(r2))
    sigma6 = sigma**6
    repulsion = 18.0 / r2**8 + 24.0 * (near3 - far3) * (near3 + far3) / r2**5
    attraction = 4.5 / r2**5 + 7.5 * (near3 - far3) * near3 / (r2 * r2)
    return 4.0 * epsilon * sigma6 * (factor12 * sigma6 * repulsion - factor6 * attraction)


def coul_charmmfsh_d2(r2, qq, cut_coul):
    return 0.25 * qq * (3.0 / r2 - 1.0 / (cut_coul * cut_coul)) / (r2 * math.sqrt(r2))


lj_charmmfsw.d2, coul_charmmfsh.d2 = lj_charmmfsw_d2, coul_charmmfsh_d2


class CharmmSwitchedPair(PairStyle):
    """Checks the switching distances, derives constants of the switches, and has tables of 1-4 pairs for both CHARMM dihedral styles."""

    charmm_constant = True
    one_four_parts = (make_part(lj_cut, "", ("epsilon", "sigma")), make_part(coul_cut, "", ()))
    one_four_shifted_parts = (make_part(lj_shifted, "", ("epsilon", "sigma")), make_part(coul_charmmfsh, "", ()))

    def parse_settings(self, words):
        values = super().parse_settings(words)
        if not 0.0 < values["inner"] < values["outer"]:
            raise InputError(f"pair_style {self.name}: inner = {values['inner']:g} must be less than outer = {values['outer']:g} and "
                             "greater than 0")
        if not values["cut_coul"] > 0.0:
            raise InputError(f"pair_style {self.name}: cut_coul must be greater than 0, got {values['cut_coul']:g}")
        return values

    def parse_coeff(self, words, settings):
        if len(words) == 3:
            raise InputError(f"pair_coeff {self.name} needs epsilon sigma [epsilon14 sigma14], got 3 values")
        return super().parse_coeff(words, settings)

    def constants(self, settings):
        a, b = settings["inner"], settings["outer"]
        a3, b3 = a**3, b**3
        out = {"inner2": a * a, "shift12": 1.0 / (a3 * b3) ** 2, "shift6": 1.0 / (a3 * b3), "factor6": b3 / (b3 - a3)}
        return {**settings, **out, "factor12": b3 * b3 / ((b3 - a3) * (b3 + a3))}

    def one_four(self, settings, filled, ntypes, units):
        """`PairTables` of `one_four_parts`: epsilon14 and sigma14 of every pair of types, without cutoff."""
        return self.ends(self.one_four_parts, settings, filled, ntypes)

    def one_four_shifted(self, settings, filled, ntypes, units):
        """The same for `one_four_shifted_parts`."""
        return self.ends(self.one_four_shifted_parts, settings, filled, ntypes)

    def ends(self, parts, settings, filled, ntypes):
        ends = {pair: {"epsilon": c["epsilon14"], "sigma": c["sigma14"]} for pair, c in filled.items()}
        return pack_parts(parts, self.constants(settings), ends, ntypes, lambda c: (math.inf, math.inf), shift=False)


OPTIONS = dict(
    settings="inner outer [cut_coul]", coeff="epsilon sigma [epsilon14] [sigma14]",
    defaults={"cut_coul": "outer", "epsilon14": "epsilon", "sigma14": "sigma"}, units={"epsilon14": "energy", "sigma14": "distance"},
    mix_rule="arithmetic", mix={"epsilon": "sigma", "sigma": "distance", "epsilon14": "sigma14", "sigma14": "distance"},
    settings_example="8.0 10.0 9.0", example="0.1 3.0 0.05 2.9", see="LAMMPS manual, pair_style lj/charmmfsw/coul/charmmfsh")

style = pair_sum("lj/charmmfsw/coul/charmmfsh", (lj_charmmfsw, "outer"), (coul_charmmfsh, "cut_coul"), cls=CharmmSwitchedPair, **OPTIONS)
style.twin = CharmmSwitchedPair("lj/charmmfsw/coul/charmmfsh", [(lj_charmmfsw_lammps, "outer"), (coul_charmmfsh, "cut_coul")],
                                doc=__doc__, **OPTIONS)
