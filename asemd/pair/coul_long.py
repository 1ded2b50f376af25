r"""The part of q_i q_j / r within the cutoff that a long-range solver leaves: C q_i q_j erfc(g r) / (dielectric r).

g is the solver's. The complementary error function is LAMMPS's approximation (M. Abramowitz, I. Stegun, Handbook of Mathematical Functions,
7.1.26, errors below 1.5e-7), and its derivative that of the exact function, as in LAMMPS without tables. Special pairs lose the part of
their bare energy that special_bonds takes off, for the solver knows nothing of bonds.
"""
from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.polynomial import chebyshev

from asemd.coulomb_table import coul_long_table
from asemd.pairstyle import pair


def coul_long_d2(r2, qq, g_ewald):
    r = math.sqrt(r2)
    x = g_ewald * r
    tail, bell = math.erfc(x), 1.12837917 * x * math.exp(-x * x)
    return qq / (4.0 * r2 * r2 * r) * (3.0 * (tail + bell) + 2.0 * x * x * bell)


def long_range(*solvers: str):
    """Mark a function as the part that these kinds of ``kspace_style`` leave to the pair style; one without charges has C6 first."""
    def mark(function):
        function.long, function.solvers = True, solvers
        return function
    return mark


EWALD = ("pppm", "ewald", "ewald/disp")


@pair("coul/long", scales=True, settings="cut", coeff="", settings_example="10.0", example="", see="LAMMPS manual, pair_style coul/long",
      d2=coul_long_d2, units={"g_ewald": "1/distance"})
@long_range(*EWALD)
def coul_long(r2, qq, g_ewald):
    r2inv = 1.0 / r2
    rinv = math.sqrt(r2inv)
    x = g_ewald * (r2 * rinv)
    gauss = math.exp(-(g_ewald * g_ewald * r2))
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss
    e = qq * rinv
    return e * tail, -0.5 * e * (tail + 1.12837917 * x * gauss) * r2inv


coul_long.table = coul_long_table


# g r and degree of the series below that are good up to there: to 1e-12 in double, to 1e-6 in single precision
DEGREES = {False: ((2.68, 22), (3.2, 24)), True: ((2.68, 13), (3.2, 14))}


def _nested(names: list[str]) -> str:
    """Nested products of a polynomial of t."""
    return names[0] if len(names) == 1 else f"({_nested(names[1:])}) * t + {names[0]}"


def _series(degree: int):
    """The function as two polynomials of r between 0 and the cutoff, which cost half of the exponential function and a division.

    Each is written as four polynomials of s^4: nested products wait for each other, but not those of different polynomials.
    """
    names = {letter: [f"{letter}{k}" for k in range(degree + 1)] for letter in "ef"}
    total = {}
    for letter, all_names in names.items():
        p = [_nested(all_names[k::4]) for k in range(4)]
        total[letter] = f"({p[0]}) + s * ({p[1]}) + u * (({p[2]}) + s * ({p[3]}))"
    source = (f"def coul_long_series(r2, qq, scale, {', '.join(names['e'] + names['f'])}):\n    r2inv = 1.0 / r2\n"
              f"    rinv = math.sqrt(r2inv)\n    s = scale * (r2 * rinv) - 1.0\n    q = qq * rinv\n    u = s * s\n    t = u * u\n"
              f"    return q * ({total['e']}), -0.5 * q * ({total['f']}) * r2inv\n")
    scope = {"math": math}
    exec(source, scope)
    function = scope["coul_long_series"]
    function.source = source
    return function


def _numbers(farthest: float, degree: int, g_ewald: float, cut: float) -> list[float] | None:
    """Constants of `coul_long_series` for a splitting parameter and a cutoff; None where the series is not good enough."""
    x = g_ewald * cut
    if not 0.0 < x <= farthest:
        return None

    def both(s, k):
        r = 0.5 * cut * (s + 1.0)
        values = [coul_long(v * v, v, g_ewald) for v in r]
        return np.array([e if k == 0 else -2.0 * d * v * v for v, (e, d) in zip(r, values)])

    return [2.0 / cut, *(c for k in (0, 1) for c in chebyshev.cheb2poly(chebyshev.chebinterpolate(both, degree, (k,))))]


coul_long.series = {single: [(_series(degree), partial(_numbers, farthest, degree)) for farthest, degree in limits]
                    for single, limits in DEGREES.items()}
