r"""$$\begin{aligned} E &= \sum_{n=1}^3 K_n [1 - \cos(n\phi - \phi_n)] + (r_{23} - r_2) A(\phi) + (r_{12} - r_1) B(\phi) \\
    &+ (r_{34} - r_3) C(\phi) + (\theta_{123} - \theta_1) D(\phi) + (\theta_{234} - \theta_2) E(\phi) \\
    &+ M (\theta_{123} - \theta_1) (\theta_{234} - \theta_2) \cos\phi + N (r_{12} - r_1) (r_{34} - r_3) \end{aligned}$$

Torsion of the class 2 force fields (COMPASS, CFF, PCFF) with its cross terms mbt, ebt, at, aat and bb13; A to E stand for sums like
$A_1 \cos\phi + A_2 \cos 2\phi + A_3 \cos 3\phi$. Source: Sun, J. Phys. Chem. B 102, 7338 (1998); LAMMPS manual, dihedral_style class2.
"""
from __future__ import annotations

import math

from asemd.cross_terms import CrossTermStyle
from asemd.style import dihedral

MARKS = {
    "mbt": "A1 A2 A3 mbt_r2",
    "ebt": "B1 B2 B3 C1 C2 C3 ebt_r1 ebt_r3",
    "at": "D1 D2 D3 E1 E2 E3 at_theta1 at_theta2",
    "aat": "M aat_theta1 aat_theta2",
    "bb13": "N bb13_r1 bb13_r3",
}
EXAMPLE = ("100 75 100 70 80 60 mbt 3.5945 0.1704 -0.5490 1.5228 ebt 0.3417 0.3264 -0.9036 0.1368 0.0 -0.8080 1.0119 1.1010 "
           "at 0.4 -0.1850 -0.7963 -2.0220 0.0 -0.3991 110.2453 105.1270 aat -13.5271 110.2453 105.1270 bb13 2.5 1.0119 1.1010")


def class2_d2(phi, r12, r23, r34, theta1, theta2, K1, phi1, K2, phi2, K3, phi3, A1, A2, A3, mbt_r2, B1, B2, B3, C1, C2, C3, ebt_r1, ebt_r3,
              D1, D2, D3, E1, E2, E3, at_theta1, at_theta2, M, aat_theta1, aat_theta2, N, bb13_r1, bb13_r3):
    c1, c2, c3 = math.cos(phi), 4.0 * math.cos(2.0 * phi), 9.0 * math.cos(3.0 * phi)             # minus the second derivatives
    s1, s2, s3 = -math.sin(phi), -2.0 * math.sin(2.0 * phi), -3.0 * math.sin(3.0 * phi)          # the first ones
    b2, b1, b3, t1, t2 = r23 - mbt_r2, r12 - ebt_r1, r34 - ebt_r3, theta1 - at_theta1, theta2 - at_theta2
    u1, u2 = theta1 - aat_theta1, theta2 - aat_theta2
    pp = K1 * math.cos(phi - phi1) + 4.0 * K2 * math.cos(2.0 * phi - phi2) + 9.0 * K3 * math.cos(3.0 * phi - phi3)
    pp -= b2 * (A1 * c1 + A2 * c2 + A3 * c3) + b1 * (B1 * c1 + B2 * c2 + B3 * c3) + b3 * (C1 * c1 + C2 * c2 + C3 * c3)
    pp -= t1 * (D1 * c1 + D2 * c2 + D3 * c3) + t2 * (E1 * c1 + E2 * c2 + E3 * c3) + M * u1 * u2 * c1
    middle, end1, end3 = A1 * s1 + A2 * s2 + A3 * s3, B1 * s1 + B2 * s2 + B3 * s3, C1 * s1 + C2 * s2 + C3 * s3
    bend1, bend2, both = D1 * s1 + D2 * s2 + D3 * s3 + M * u2 * s1, E1 * s1 + E2 * s2 + E3 * s3 + M * u1 * s1, M * c1
    return ((pp, end1, middle, end3, bend1, bend2), (end1, 0.0, 0.0, N, 0.0, 0.0), (middle, 0.0, 0.0, 0.0, 0.0, 0.0),
            (end3, N, 0.0, 0.0, 0.0, 0.0), (bend1, 0.0, 0.0, 0.0, 0.0, both), (bend2, 0.0, 0.0, 0.0, both, 0.0))


@dihedral("class2", cls=CrossTermStyle, marks=MARKS, example=EXAMPLE, d2=class2_d2)
def class2(phi, r12, r23, r34, theta1, theta2, K1: "energy", phi1: "angle", K2: "energy", phi2: "angle", K3: "energy", phi3: "angle",
           A1: "energy/distance", A2: "energy/distance", A3: "energy/distance", mbt_r2: "distance",
           B1: "energy/distance", B2: "energy/distance", B3: "energy/distance",
           C1: "energy/distance", C2: "energy/distance", C3: "energy/distance", ebt_r1: "distance", ebt_r3: "distance",
           D1: "energy", D2: "energy", D3: "energy", E1: "energy", E2: "energy", E3: "energy", at_theta1: "angle", at_theta2: "angle",
           M: "energy", aat_theta1: "angle", aat_theta2: "angle", N: "energy/distance^2", bb13_r1: "distance", bb13_r3: "distance"):
    # beyond 90 degrees the angle counts from trans, so that terms whose forces cancel in a planar molecule do so to the last digit
    x, sign = phi, 1.0
    if abs(phi) > 0.5 * math.pi:
        x, sign = phi - math.copysign(math.pi, phi), -1.0
    c1, s1 = sign * math.cos(x), sign * math.sin(x)
    c2, c3 = (c1 - s1) * (c1 + s1), c1 * (1.0 - 4.0 * s1 * s1)
    s2, s3 = 4.0 * s1 * c1, 3.0 * s1 * (2.0 * c1 - 1.0) * (2.0 * c1 + 1.0)        # minus the derivatives of c2 and c3
    h1, h2, h3 = math.sin(0.5 * (phi - phi1)), math.sin(phi - 0.5 * phi2), math.sin(0.5 * (3.0 * phi - phi3))
    e = 2.0 * (K1 * h1 * h1 + K2 * h2 * h2 + K3 * h3 * h3)
    slope = sign * K1 * math.sin(x - phi1) + 2.0 * K2 * math.sin(2.0 * x - phi2) + sign * 3.0 * K3 * math.sin(3.0 * x - phi3)
    # of each cosine series its value is the slope by the length or angle it multiplies
    middle, end1, end3 = A1 * c1 + A2 * c2 + A3 * c3, B1 * c1 + B2 * c2 + B3 * c3, C1 * c1 + C2 * c2 + C3 * c3
    bend1, bend2 = D1 * c1 + D2 * c2 + D3 * c3, E1 * c1 + E2 * c2 + E3 * c3
    b2, b1, b3, t1, t2 = r23 - mbt_r2, r12 - ebt_r1, r34 - ebt_r3, theta1 - at_theta1, theta2 - at_theta2
    u1, u2, n1, n3 = theta1 - aat_theta1, theta2 - aat_theta2, r12 - bb13_r1, r34 - bb13_r3
    e += b2 * middle + b1 * end1 + b3 * end3 + t1 * bend1 + t2 * bend2 + M * u1 * u2 * c1 + N * n1 * n3
    slope -= b2 * (A1 * s1 + A2 * s2 + A3 * s3) + b1 * (B1 * s1 + B2 * s2 + B3 * s3) + b3 * (C1 * s1 + C2 * s2 + C3 * s3)
    slope -= t1 * (D1 * s1 + D2 * s2 + D3 * s3) + t2 * (E1 * s1 + E2 * s2 + E3 * s3) + M * u1 * u2 * s1
    return e, slope, end1 + N * n3, middle, end3 + N * n1, bend1 + M * u2 * c1, bend2 + M * u1 * c1
