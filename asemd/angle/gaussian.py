r"""$$E = -k_B T \ln\left( \sum_i \frac{A_i}{w_i \sqrt{\pi/2}} \exp\left[ -\frac{2 (\theta - \theta_i)^2}{w_i^2} \right] \right)$$

Boltzmann inverse of a distribution of angles that is a sum of n Gaussians: ``angle_coeff 1 T n A_1 w_1 theta_1 ... A_n w_n theta_n``,
widths in radians and centres in degrees.
Source: Milano, Goudeau and Mueller-Plathe, J. Polym. Sci. B 43, 871 (2005); LAMMPS manual, angle_style gaussian.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.style import Packed, Parameter, Style, angle, radians

TERM = (Parameter("A"), Parameter("w"), Parameter("theta", "angle"))


class GaussianAngle(Style):
    """Any number of terms: a list ``terms`` of (A, w, theta) beside T and n."""

    def parse_coeff(self, words, settings):
        values = super().parse_coeff(words[:2], settings)
        rest, n = words[2:], values["n"]
        if n < 1:
            raise InputError(f"angle_coeff gaussian: n must be 1 or more, got {n}")
        if len(rest) != 3 * n:
            raise InputError(f"angle_coeff gaussian needs T n and A w theta for each of n = {n} terms, got {len(rest)} values after n")
        read = [p.read(word, "angle_coeff gaussian") for p, word in zip(TERM * n, rest)]
        values["terms"] = [tuple(read[k:k + 3]) for k in range(0, 3 * n, 3)]
        for k, (weight, width, _) in enumerate(values["terms"], 1):
            if weight <= 0.0 or width <= 0.0:
                raise InputError(f"angle_coeff gaussian: A_{k} and w_{k} must be > 0, got {weight:g} and {width:g}")
        return values

    def format_coeff(self, coeff):
        return super().format_coeff(coeff) + [repr(value) for term in coeff["terms"] for value in term]

    def pack(self, settings, coeffs, ntypes, units):
        out, rows = np.zeros((3, ntypes + 1)), []
        for t, values in coeffs.items():
            out[:, t] = (units.boltz if units else 1.0) * values["T"], len(rows), values["n"]
            rows += [(math.log(a / (w * math.sqrt(0.5 * math.pi))), w, radians(centre)) for a, w, centre in values["terms"]]
        return Packed(out, (np.array(rows),))


def gaussian_d2(theta, kT, first, count, terms):
    begin, end = int(first), int(first + count)
    top = -math.inf
    for k in range(begin, end):
        q = (theta - terms[k, 2]) / terms[k, 1]
        top = max(top, terms[k, 0] - 2.0 * q * q)
    total = pull = bend = 0.0
    for k in range(begin, end):
        w = terms[k, 1]
        q = (theta - terms[k, 2]) / w
        p = math.exp(terms[k, 0] - 2.0 * q * q - top)
        total += p
        pull += p * q / w
        bend += p * (1.0 - 4.0 * q * q) / (w * w)
    pull /= total
    return 4.0 * kT * (bend / total + 4.0 * pull * pull)


@angle("gaussian", cls=GaussianAngle, d2=gaussian_d2, coeff=(Parameter("T", "temperature"), Parameter("n", "integer")),
       example="300.0 2 0.0128 0.375 80.0 0.0730 0.148 123.0", rest=lambda coeff: coeff["terms"][0][2])
def gaussian(theta, kT, first, count, terms: "array"):
    begin, end = int(first), int(first + count)
    top = -math.inf                 # the largest exponent is taken out, so that the sum never underflows
    for k in range(begin, end):
        q = (theta - terms[k, 2]) / terms[k, 1]
        top = max(top, terms[k, 0] - 2.0 * q * q)
    total = slope = 0.0
    for k in range(begin, end):
        q = (theta - terms[k, 2]) / terms[k, 1]
        p = math.exp(terms[k, 0] - 2.0 * q * q - top)
        total += p
        slope += p * q / terms[k, 1]
    return -kT * (top + math.log(total)), 4.0 * kT * slope / total
