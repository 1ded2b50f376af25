r"""$$E = K (r - r_{t=0})^2$$

Spring that keeps each bond at the length it has at the beginning of the first run or minimisation after the style was chosen; the usual
factor 1/2 is included in K. Source: LAMMPS manual, bond_style harmonic/restrain.
"""
from __future__ import annotations

from asemd.style import bond


@bond("harmonic/restrain", example="80.0", remembers="atoms")
def harmonic_restrain(r, reference, K: "energy/distance^2"):
    dr = r - reference
    return K * dr * dr, 2.0 * K * dr
