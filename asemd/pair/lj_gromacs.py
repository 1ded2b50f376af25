r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] + S(r) \qquad r < r_c, \qquad
    S = \tfrac{A}{3} (r - r_1)^3 + \tfrac{B}{4} (r - r_1)^4 + C \;\; (r > r_1), \quad C \;\; (r \le r_1)$$

Lennard-Jones moved and smoothed between inner (r1) and outer (rc) so that energy, force and its derivative end at zero, as in GROMACS; used
by the MARTINI force field.  van der Spoel et al., GROMACS manual; Marrink et al., J. Phys. Chem. B 108, 750 (2004).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, pair


def switch(energy: float, slope: float, curve: float, inner: float, outer: float) -> tuple[float, float, float]:
    """A/3, B/4 and C of S(r) for a function with these energy and derivatives at `outer`."""
    w = outer - inner
    return ((w * curve - 3.0 * slope) / (3.0 * w * w), (2.0 * slope - w * curve) / (4.0 * w * w * w),
            0.5 * w * slope - energy - w * w * curve / 12.0)


def derived(c, settings):
    """A/3, B/4 and C."""
    rc = c["outer"]
    s6 = (c["sigma"] / rc) ** 6
    e = 4.0 * c["epsilon"] * s6
    names = ("third", "fourth", "constant")
    return dict(zip(names, switch(e * (s6 - 1.0), e * (6.0 - 12.0 * s6) / rc, e * (156.0 * s6 - 42.0) / rc**2, c["inner"], rc)))


class SwitchedPair(PairStyle):
    """Checks the inner and the outer cutoff of all pairs and of one pair, which are given together."""

    positive = True      # inner must be more than 0

    def parse_settings(self, words):
        return self.ordered(super().parse_settings(words), "pair_style")

    def parse_coeff(self, words, settings):
        if len(words) == len([p for p in self.coeff if not p.optional]) + 1:
            raise InputError(f"pair_coeff {self.name}: inner and outer come together, one of them is missing")
        return self.ordered(super().parse_coeff(words, settings), "pair_coeff")

    def ordered(self, values, command):
        a, b = values.get("inner"), values.get("outer")
        if a is not None and (not a < b or a < 0.0 or (self.positive and a == 0.0)):
            raise InputError(f"{command} {self.name}: inner = {a:g} must be less than outer = {b:g} and "
                             f"{'greater than 0' if self.positive else 'not negative'}")
        return values

    def reset_cutoffs(self, coeffs):
        return {pair_: {n: v for n, v in values.items() if n not in ("inner", "outer")} for pair_, values in coeffs.items()}


def lj_gromacs_d2(r2, epsilon, sigma, inner, third, fourth, constant):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    r = math.sqrt(r2)
    t = r - inner if r > inner else 0.0
    slope = t * t * (3.0 * third + 4.0 * fourth * t)
    curve = t * (6.0 * third + 12.0 * fourth * t)
    return 24.0 * epsilon * s6 * (7.0 * s6 - 2.0) * r2inv * r2inv + 0.25 * (curve - slope / r) * r2inv


@pair("lj/gromacs", settings="inner outer", coeff="epsilon sigma [inner] [outer]", cut="outer", derived=derived, cls=SwitchedPair,
      mix={"epsilon": "sigma", "sigma": "distance", "inner": "distance", "outer": "distance"}, rows="third fourth constant", shifts=False,
      settings_example="2.0 2.5", example="1.0 1.1 1.9 2.4", d2=lj_gromacs_d2, see="LAMMPS manual, pair_style lj/gromacs")
def lj_gromacs(r2, epsilon: "energy", sigma: "distance", inner: "distance", third, fourth, constant):
    r2inv = 1.0 / r2
    s2 = sigma * sigma * r2inv
    s6 = s2 * s2 * s2
    e = epsilon * s6
    r = math.sqrt(r2)
    t = r - inner if r > inner else 0.0
    t3 = t * t * t
    return (4.0 * e * (s6 - 1.0) + (t3 * (third + fourth * t) + constant),
            -12.0 * e * (2.0 * s6 - 1.0) * r2inv + 0.5 * t * t * (3.0 * third + 4.0 * fourth * t) * r * r2inv)
