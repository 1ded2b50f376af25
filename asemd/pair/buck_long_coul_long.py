r"""$$E = A e^{-r / \rho} - C g_6^6 \left( \frac{1}{u^3} + \frac{1}{u^2} + \frac{1}{2 u} \right) e^{-u}
    + \frac{C_q q_i q_j \, \mathrm{erfc}(g r)}{\epsilon_0 r}, \qquad u = g_6^2 r^2, \quad r < r_c$$

Buckingham's potential whose attraction has no cutoff: a long-range solver (ewald/disp or pppm/disp) adds the rest. With ``cut`` instead of
``long`` the first part is buck. Coulomb is ``long`` or ``off``; special pairs: see lj/long/coul/long.
"""
from __future__ import annotations

import inspect
import math

from asemd.pair.buck import buck, check
from asemd.pair.lj_long_coul_long import DispersionPair, dispersion
from asemd.style import register


def repulsion_d2(r, A, rho):
    return A * math.exp(-r / rho) / (rho * rho)


def repulsion(r, A: "energy", rho: "distance"):
    """The repulsive part of buck."""
    e = A * math.exp(-r / rho)
    return e, -e / rho


def derived(c, settings):
    return {"C6": c["C"]}


class BuckinghamDispersion(DispersionPair):
    kinds = ("long", "cut")


repulsion.d2 = repulsion_d2
register(BuckinghamDispersion(
    "buck/long/coul/long", [buck], [repulsion, dispersion], "cut_buck", coeff="A rho C [cut_buck]", rows="C6", derived=derived, check=check,
    units={"C": "energy*distance^6"}, settings_example="long long 10.0", example="100.0 0.3 20.0",
    splits=True, see="LAMMPS manual, pair_style buck/long/coul/long", doc=inspect.cleandoc(__doc__)))
