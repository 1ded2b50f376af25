r"""Modified embedded-atom method of one element, its functions as cubic splines, with triples as in Stillinger and Weber's potential.

$$E=\sum_{i<j}\phi(r_{ij})+\sum_i\big[U(\rho_i)-U(0)\big]+\sum_i\sum_{j<k}F(r_{ij})F(r_{ik})\,G(\cos\theta_{jik})$$

$\rho_i$ is that of `pair meam/spline`. The file has the splines phi, F, G, rho, U, f, g. Atoms whose type is NULL are left out;
LAMMPS counts them like the others.

Source: LAMMPS manual, pair_style meam/sw/spline; Lenosky et al., Modelling Simul. Mater. Sci. Eng. 8, 825 (2000).
"""
from __future__ import annotations

from asemd.pair.meam_spline import MeamSpline
from asemd.style import register

register(MeamSpline("meam/sw/spline", True, converts=False, doc=__doc__, example="Ti.meam.sw.spline Ti",
                    see="T. J. Lenosky et al., Modelling Simul. Mater. Sci. Eng. 8, 825 (2000)"))
