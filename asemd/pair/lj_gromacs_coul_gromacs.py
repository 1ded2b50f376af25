r"""$$E = 4\epsilon \left[ (\sigma/r)^{12} - (\sigma/r)^6 \right] + S_{LJ}(r) + C q_i q_j \left[ 1/r + S_C(r) \right] / \epsilon$$

The sum of lj/gromacs between inner and outer and of a Coulomb part that is moved and smoothed in the same way between inner_coul and
outer_coul.  van der Spoel et al., GROMACS manual; Marrink et al., J. Phys. Chem. B 108, 750 (2004).
"""
from __future__ import annotations

from asemd.pair.lj_gromacs import SwitchedPair, lj_gromacs
from asemd.pair.lj_gromacs import derived as lj_derived
from asemd.pairstyle import pair_sum


def derived(c, settings):
    """Begin and numbers of the Lennard-Jones switch."""
    return {"inner": settings["inner"], **lj_derived({**settings, **c}, settings)}


class GromacsPair(SwitchedPair):
    """Both parts have cutoffs of their own, the same for all pairs of types."""

    positive = False

    def ordered(self, values, command):
        super().ordered(values, command)
        super().ordered({"inner": values.get("inner_coul"), "outer": values.get("outer_coul")}, command)
        return values

    def constants(self, settings):
        a, b = settings["inner_coul"], settings["outer_coul"]
        w = b - a
        third, fourth = (5.0 * b - 2.0 * a) / (3.0 * b**3 * w * w), (a - 2.0 * b) / (2.0 * b**3 * w**3)
        level = 1.0 / b + w**3 * (third + fourth * w)
        # r (1/r + S) is a polynomial with a threefold zero at b: (b - r)^3 (p0 + p1 r + p2 r^2)
        p0, p2 = 1.0 / b**3, -fourth
        p1 = (3.0 * b * b * p0 - level - third * a**3 + fourth * a**4) / b**3
        return {**settings, "level": level, "p0": p0, "p1": p1, "p2": p2}


def coul_gromacs(r, qq, inner_coul: "distance", outer_coul: "distance", level, p0, p1, p2):
    rinv = 1.0 / r
    c = qq * rinv
    gap = outer_coul - r
    p = p0 + r * (p1 + r * p2)
    slope = p1 + 2.0 * p2 * r
    near = r <= inner_coul
    e = c - qq * level if near else c * gap * gap * gap * p
    return e, (-c * rinv if near else c * gap * gap * (gap * (slope - p * rinv) - 3.0 * p))


def coul_gromacs_d2(r, qq, inner_coul, outer_coul, level, p0, p1, p2):
    if r <= inner_coul:
        return 2.0 * qq / (r * r * r)
    gap, p, slope = outer_coul - r, p0 + r * (p1 + r * p2), p1 + 2.0 * p2 * r
    u, v = gap * gap * gap * p, gap * gap * (gap * slope - 3.0 * p)                  # r E / qq and its derivative
    w = gap * (6.0 * p - 6.0 * gap * slope + 2.0 * gap * gap * p2)
    return qq * (w - 2.0 * (v - u / r) / r) / r


coul_gromacs.d2 = coul_gromacs_d2
pair_sum("lj/gromacs/coul/gromacs", (lj_gromacs, "outer"), (coul_gromacs, "outer_coul"), cls=GromacsPair,
         settings="inner outer [inner_coul] [outer_coul]", coeff="epsilon sigma", derived=derived, rows="inner third fourth constant",
         defaults={"inner_coul": "inner", "outer_coul": "outer"}, mix={"epsilon": "sigma", "sigma": "distance"}, shifts=False,
         settings_example="8.0 10.0 7.0 9.0", example="0.1 3.0", see="LAMMPS manual, pair_style lj/gromacs/coul/gromacs")
