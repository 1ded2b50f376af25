r"""E = A [1 + cos(pi r / cut)] for r < cut.  Finite everywhere, so it pushes overlapping atoms apart.

Written as 2 A sin^2(pi (cut - r) / (2 cut)), which keeps all digits near the cutoff. The sine is its power series in w = x/pi <= 1/2
(coefficients pi^n/n! with alternating sign): it vectorises, and sin(pi r/cut)/r has its finite limit at r = 0.
"""
from __future__ import annotations

import math

from asemd.pairstyle import pair


def soft_d2(r2, A, cut):
    k = math.pi / cut
    u = k * math.sqrt(r2)
    if u < 0.5:      # (u cos u - sin u) / u^3 as a power series, where digits would cancel
        w = u * u
        bend = w * (1.0 / 45360.0 - w * (1.0 / 3991680.0 - w * (1.0 / 518918400.0 - w / 93405312000.0)))
        bend = -1.0 / 3.0 + w * (1.0 / 30.0 - w * (1.0 / 840.0 - bend))
    else:
        bend = (u * math.cos(u) - math.sin(u)) / (u * u * u)
    return -0.25 * A * k * k * k * k * bend


@pair("soft", settings="cut", coeff="A [cut]", mix={"A": "geometric"}, settings_example="1.2", example="10.0 1.1",
      see="LAMMPS manual, pair_style soft", d2=soft_d2)
def soft(r2, A: "energy", cut: "distance"):
    r = math.sqrt(r2)
    gap = (cut - r) / cut
    near = r + r < cut
    half = 0.5 * gap
    w = half * half
    sine = 5.392664662608129e-10 * w - 2.2948428997269873e-08
    sine = (sine * w + 7.952054001475513e-07) * w - 2.1915353447830217e-05
    sine = (sine * w + 0.00046630280576761255) * w - 0.0073704309457143504
    sine = (sine * w + 0.08214588661112823) * w - 0.5992645293207921
    sine = (sine * w + 2.5501640398773455) * w - 5.16771278004997
    sine = sine * w + 3.141592653589793
    root = half * sine
    u = r / cut
    w = u * u if near else gap * gap
    slope = 5.392664662608129e-10 * w - 2.2948428997269873e-08
    slope = (slope * w + 7.952054001475513e-07) * w - 2.1915353447830217e-05
    slope = (slope * w + 0.00046630280576761255) * w - 0.0073704309457143504
    slope = (slope * w + 0.08214588661112823) * w - 0.5992645293207921
    slope = (slope * w + 2.5501640398773455) * w - 5.16771278004997
    slope = slope * w + 3.141592653589793
    slope = slope / cut if near else slope * gap / r
    return 2.0 * A * root * root, -1.5707963267948966 * A * slope / cut
