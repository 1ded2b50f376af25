r"""$$E = \sum_{i=1}^{m} K_i [1 + \cos(n_i \phi - d_i)]$$

Sum of torsions with any multiplicities and phases. Three atoms on a line have the mean energy, the sum of all K.
Source: LAMMPS manual, dihedral_style fourier.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.series import SeriesStyle
from asemd.style import Parameter, dihedral


def check(coeff, settings):
    for k in range(1, coeff["m"] + 1):
        if coeff[f"n{k}"] < 0:
            raise InputError(f"dihedral_coeff fourier: incorrect multiplicity, n{k} must be 0 or more, got {coeff[f'n{k}']}")


TERM = (Parameter("K", "energy"), Parameter("n", "integer"), Parameter("d", "angle"))


def on_line(first, count, terms):
    e = 0.0
    for k in range(int(first), int(first) + int(count)):
        K = terms[k, 0]
        e += K * (1.0 + math.cos(terms[k, 2])) if terms[k, 1] == 0.0 else K
    return e


def fourier_d2(phi, first, count, terms):
    bend = 0.0
    for k in range(int(first), int(first) + int(count)):
        bend -= terms[k, 0] * terms[k, 1] * terms[k, 1] * math.cos(terms[k, 1] * phi - terms[k, 2])
    return bend


@dihedral("fourier", cls=SeriesStyle, count="m", term=TERM, check=check, straight=on_line, d2=fourier_d2,
          example="3 -0.846200 3 0.0 7.578800 1 0 0.138000 2 -180.0")
def fourier(phi, first, count, terms: "array"):
    # beyond 90 degrees the angle counts from trans, so that terms whose forces cancel in a planar molecule do so to the last digit
    x, flipped = phi, 0.0
    if abs(phi) > 0.5 * math.pi:
        x, flipped = phi - math.copysign(math.pi, phi), 1.0
    e = slope = 0.0
    for k in range(int(first), int(first) + int(count)):
        K, n = terms[k, 0], terms[k, 1]
        a = n * x - terms[k, 2]
        if flipped * n % 2.0 == 1.0:  # 1 - cos(a) = 2 sin^2(a/2)
            s = math.sin(0.5 * a)
            e += 2.0 * K * s * s
            slope += K * n * math.sin(a)
        else:                         # 1 + cos(a) = 2 cos^2(a/2)
            c = math.cos(0.5 * a)
            e += 2.0 * K * c * c
            slope -= K * n * math.sin(a)
    return e, slope
