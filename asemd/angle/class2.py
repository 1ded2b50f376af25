r"""$$E = K_2 \Delta^2 + K_3 \Delta^3 + K_4 \Delta^4 + M (r_{12} - r_1)(r_{32} - r_2)
    + N_1 (r_{12} - r_1') \Delta + N_2 (r_{32} - r_2') \Delta, \quad \Delta = \theta - \theta_0$$

Angle of the COMPASS and PCFF force fields with its bond-bond term (coefficients after ``bb``: M, r1, r2) and bond-angle term (after
``ba``: N1, N2, r1', r2'). Source: Sun, J. Phys. Chem. B 102, 7338 (1998); LAMMPS manual, angle_style class2.
"""
from __future__ import annotations

from asemd.cross_terms import CrossTermStyle
from asemd.style import angle

MARKS = {"bb": "M bb_r1 bb_r2", "ba": "N1 N2 ba_r1 ba_r2"}


def class2_d2(theta, r12, r32, theta0, K2, K3, K4, M, bb_r1, bb_r2, N1, N2, ba_r1, ba_r2):
    d = theta - theta0
    return (2.0 * K2 + d * (6.0 * K3 + d * 12.0 * K4), N1, N2), (N1, 0.0, M), (N2, M, 0.0)


@angle("class2", cls=CrossTermStyle, marks=MARKS, example="110.1 75.0 5.2 1.0 bb 10.0 1.5 1.4 ba 20.0 10.0 1.5 1.3", equilibrium="theta0",
       d2=class2_d2)
def class2(theta, r12, r32, theta0: "angle", K2: "energy", K3: "energy", K4: "energy", M: "energy/distance^2", bb_r1: "distance",
           bb_r2: "distance", N1: "energy/distance", N2: "energy/distance", ba_r1: "distance", ba_r2: "distance"):
    d = theta - theta0
    u, v = r12 - bb_r1, r32 - bb_r2
    bend = N1 * (r12 - ba_r1) + N2 * (r32 - ba_r2)
    e = d * (d * (K2 + d * (K3 + d * K4)) + bend) + M * u * v
    return e, d * (2.0 * K2 + d * (3.0 * K3 + d * 4.0 * K4)) + bend, M * v + N1 * d, M * u + N2 * d
