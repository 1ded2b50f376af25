r"""$$E = f(\theta_{123})\, f(\theta_{234})\, E_{table}(\phi), \quad f(\theta) = K \text{ below } \theta_1, \quad
f(\theta) = K \left(1 - \frac{(\theta - \theta_1)^2}{(\theta_2 - \theta_1)^2}\right) \text{ above}$$

A tabulated torsion that fades out as three of its atoms come to lie on a line, for coarse-grained chains. The factor is zero at
$\theta_2$ and goes on below zero beyond it, as LAMMPS has it: take an angle that is not reached, 180 degrees at most.
Source: Salerno and Bernstein, J. Chem. Theory Comput. 14, 2219 (2018); LAMMPS manual, dihedral_style table/cut.
"""
from __future__ import annotations

import math

from asemd.bonded_table import INTERPOLATED, interpolate
from asemd.dihedral.table import DihedralTable
from asemd.errors import InputError
from asemd.style import Parameter, dihedral

CUT = (Parameter("style", "word"), Parameter("K"), Parameter("angle1", "angle"), Parameter("angle2", "angle"))


class DihedralTableCut(DihedralTable):
    """Words before the file: ``aat``, the factor K, and the angles where it begins to fall and where it is zero."""

    coeff_before = CUT

    def parse_coeff(self, words, settings):
        if words and words[0] != "aat":
            raise InputError(f"dihedral_coeff table/cut: unknown style of cutoff {words[0]!r}, must be aat")
        return super().parse_coeff(words, settings)

    def check(self, coeff, settings):
        if not coeff["angle1"] < coeff["angle2"]:
            raise InputError(f"dihedral_coeff table/cut: angle2 must be larger than angle1, got {coeff['angle1']:g} {coeff['angle2']:g}")


@dihedral("table/cut", cls=DihedralTableCut, xfail=INTERPOLATED, example="aat 1.2 80 140 file KEYWORD")
def table_cut(phi, theta1, theta2, lo, hi, delta, first, rows, mode, K, angle1: "angle", angle2: "angle", nodes: "array"):
    if not -3.5 < phi < 3.5:
        return math.inf, math.inf, math.inf, math.inf
    e, slope = interpolate(phi if phi >= 0.0 else phi + hi, lo, delta, first, rows, mode, nodes)
    width = angle2 - angle1
    p, q, fall_p, fall_q = K, K, 0.0, 0.0
    if theta1 > angle1:
        p, fall_p = K * ((angle2 - theta1) / width) * ((theta1 - angle1 + width) / width), -2.0 * K * (theta1 - angle1) / (width * width)
    if theta2 > angle1:
        q, fall_q = K * ((angle2 - theta2) / width) * ((theta2 - angle1 + width) / width), -2.0 * K * (theta2 - angle1) / (width * width)
    return p * q * e, p * q * slope, fall_p * q * e, p * fall_q * e
