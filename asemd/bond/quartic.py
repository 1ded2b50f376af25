r"""$$E = K (r - R_c)^2 (r - R_c - B_1)(r - R_c - B_2) + U_0
    + \left\{ 4 \left[ r^{-12} - r^{-6} \right] + 1 \ \text{for}\ r < 2^{1/6} \right\}$$

Bond of bead-spring polymers that breaks for good when it gets longer than $R_c$: from then on the atoms have the pair interaction that the
bond replaces. Epsilon and sigma of the repulsion are 1 in the units of the scene. LAMMPS takes the pair energy of bonded atoms out of
``evdwl`` with its Coulomb part and out of ``engpot`` of compute bond/local once more; here each
part is where it belongs, and sums are the same.
Source: Stevens, Macromolecules 34, 2710 (2001); LAMMPS manual, bond_style quartic.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.style import Style, bond


class Quartic(Style):
    def check_scene(self, interactions, system):
        if not interactions.uses["pair"]:
            raise InputError("bond_style quartic needs a pair style: it takes over when a bond breaks")
        if tuple(interactions.special_lj) != (1.0, 1.0, 1.0):
            raise InputError("bond_style quartic needs special_bonds lj/coul 1 1 1")
        for category in ("angle", "dihedral", "improper"):
            if interactions.uses[category]:
                raise InputError(f"bond_style quartic cannot be used together with {category}_style "
                                 f"{interactions.style_name(category)}: set {category}_style none")


@bond("quartic", cls=Quartic, example="1200.0 -0.55 0.25 1.3 34.6878", rest=lambda coeff: 0.97,
      breaks="off", domain="the bond must be longer than 0")
def quartic(r, K: "energy/distance^4", B1: "distance^1", B2: "distance^1", Rc: "distance", U0: "energy"):
    # B1 and B2 are lengths that may be negative: no warning of that
    if r > Rc:
        return math.nan, math.nan
    if r == 0.0:
        return math.inf, math.inf
    dr = r - Rc
    a = dr - B1
    b = dr - B2
    slope = K * dr * (2.0 * a * b + dr * (a + b))
    repulsion = 0.0
    inverse = 1.0 / r
    s2 = inverse * inverse
    s6 = s2 * s2 * s2
    if s6 > 0.5:
        slope -= 48.0 * s6 * (s6 - 0.5) * inverse
        repulsion = 4.0 * (s6 - 0.5) * (s6 - 0.5)
    return K * dr * dr * a * b + U0 + repulsion, slope
