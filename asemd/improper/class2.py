r"""$$E = K (\chi - \chi_0)^2 + M_1 (\theta_{ijk} - \theta_1)(\theta_{kjl} - \theta_3)
    + M_2 (\theta_{ijk} - \theta_1)(\theta_{ijl} - \theta_2) + M_3 (\theta_{ijl} - \theta_2)(\theta_{kjl} - \theta_3)$$

Out-of-plane term of COMPASS and its relatives: chi is the mean of the three angles between a bond of the second atom and the plane of its
other two bonds, with a sign. The products of angles are given on a second line, ``improper_coeff 1 aa M1 M2 M3 theta1 theta2 theta3``, or
in the data file under ``AngleAngle Coeffs``. Source: Sun, J. Phys. Chem. B 102, 7338 (1998); LAMMPS manual, improper_style class2.
"""
from __future__ import annotations

import math

from asemd.cross_terms import CrossTermStyle
from asemd.kernels.geometry import angle_between, cross, elevation, low
from asemd.style import improper


class ImproperClass2(CrossTermStyle):
    def functions(self):
        return low, cross, angle_between, elevation, self.function


@improper("class2", cls=ImproperClass2, marks={"aa": "M1 M2 M3 theta1 theta2 theta3"}, centre=2, equilibrium="chi0",
          example="45.0 4.0 aa 12.0 -9.0 15.0 109.5 115.0 121.0", domain="no bond of the second atom may have length 0")
def class2(ax, ay, az, bx, by, bz, cx, cy, cz, K: "energy", chi0: "angle", M1: "energy", M2: "energy", M3: "energy",
           theta1: "angle", theta2: "angle", theta3: "angle"):
    if not (ax * ax + ay * ay + az * az > 0.0 and bx * bx + by * by + bz * bz > 0.0 and cx * cx + cy * cy + cz * cz > 0.0):
        return math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf, math.inf
    x1, b1x, b1y, b1z, c1x, c1y, c1z, a1x, a1y, a1z = elevation(bx, by, bz, cx, cy, cz, ax, ay, az)
    x2, c2x, c2y, c2z, a2x, a2y, a2z, b2x, b2y, b2z = elevation(cx, cy, cz, ax, ay, az, bx, by, bz)
    x3, a3x, a3y, a3z, b3x, b3y, b3z, c3x, c3y, c3z = elevation(ax, ay, az, bx, by, bz, cx, cy, cz)
    t1, a4x, a4y, a4z, b4x, b4y, b4z = angle_between(ax, ay, az, bx, by, bz)
    t2, a5x, a5y, a5z, c5x, c5y, c5z = angle_between(ax, ay, az, cx, cy, cz)
    t3, b6x, b6y, b6z, c6x, c6y, c6z = angle_between(bx, by, bz, cx, cy, cz)
    d, d1, d2, d3 = (x1 + x2 + x3) / 3.0 - chi0, t1 - theta1, t2 - theta2, t3 - theta3
    s, s1, s2, s3 = 2.0 * K * d / 3.0, M1 * d3 + M2 * d2, M2 * d1 + M3 * d3, M1 * d1 + M3 * d2
    return (K * d * d + M1 * d1 * d3 + M2 * d1 * d2 + M3 * d2 * d3,
            s * (a1x + a2x + a3x) + s1 * a4x + s2 * a5x, s * (a1y + a2y + a3y) + s1 * a4y + s2 * a5y,
            s * (a1z + a2z + a3z) + s1 * a4z + s2 * a5z, s * (b1x + b2x + b3x) + s1 * b4x + s3 * b6x,
            s * (b1y + b2y + b3y) + s1 * b4y + s3 * b6y, s * (b1z + b2z + b3z) + s1 * b4z + s3 * b6z,
            s * (c1x + c2x + c3x) + s2 * c5x + s3 * c6x, s * (c1y + c2y + c3y) + s2 * c5y + s3 * c6y,
            s * (c1z + c2z + c3z) + s2 * c5z + s3 * c6z)
