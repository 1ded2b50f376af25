r"""$$E = \sum_{n=2}^{6} K_n \Delta^n + M (r_{12} - r_1)(r_{32} - r_2)
    + N_1 (r_{12} - r_1') \Delta + N_2 (r_{32} - r_2') \Delta, \quad \Delta = \theta - \theta_0$$

Angle style class2 with powers up to six, as QuickFF fits them; cross terms after ``bb`` and ``ba`` as in class2.
Source: Vanduyfhuys et al., J. Comput. Chem. 36, 1015 (2015); LAMMPS manual, angle_style class2/p6.
"""
from __future__ import annotations

from asemd.angle.class2 import MARKS
from asemd.cross_terms import CrossTermStyle
from asemd.style import angle


def class2_p6_d2(theta, r12, r32, theta0, K2, K3, K4, K5, K6, M, bb_r1, bb_r2, N1, N2, ba_r1, ba_r2):
    d = theta - theta0
    return (2.0 * K2 + d * (6.0 * K3 + d * (12.0 * K4 + d * (20.0 * K5 + d * 30.0 * K6))), N1, N2), (N1, 0.0, M), (N2, M, 0.0)


@angle("class2/p6", cls=CrossTermStyle, marks=MARKS, equilibrium="theta0", d2=class2_p6_d2,
       example="110.1 75.0 5.2 1.0 -0.5 0.3 bb 10.0 1.5 1.4 ba 20.0 10.0 1.5 1.3")
def class2_p6(theta, r12, r32, theta0: "angle", K2: "energy", K3: "energy", K4: "energy", K5: "energy", K6: "energy",
              M: "energy/distance^2", bb_r1: "distance", bb_r2: "distance", N1: "energy/distance", N2: "energy/distance",
              ba_r1: "distance", ba_r2: "distance"):
    d = theta - theta0
    u, v = r12 - bb_r1, r32 - bb_r2
    bend = N1 * (r12 - ba_r1) + N2 * (r32 - ba_r2)
    e = d * (d * (K2 + d * (K3 + d * (K4 + d * (K5 + d * K6)))) + bend) + M * u * v
    slope = d * (2.0 * K2 + d * (3.0 * K3 + d * (4.0 * K4 + d * (5.0 * K5 + d * 6.0 * K6)))) + bend
    return e, slope, M * v + N1 * d, M * u + N2 * d
