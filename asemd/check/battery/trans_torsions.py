r"""Torsions a hair from trans, where the cosine does not tell one angle from the next and the sine has to be had in another way.

Bond angles are 90 degrees and bonds 1 long, and the last atom is at :math:`(1, -\cos\delta, \sin\delta)`: the torsion angle is
:math:`180° - \delta`, and the force on the last atom is :math:`dE/d\phi`, along the tangent. Down to :math:`\delta` of 1e-6 degrees the
coordinates hold it to 16 digits, and an expression in the cross products loses no more than the rounding of an angle near :math:`\pi`,
2.2e-16 to 4.4e-16. The figure is the relative error of the force times :math:`\delta`, which is the error of the angle that would cause
it; the limit is 2e-15. Energies: :math:`K (\phi - 180°)^2` (quadratic), :math:`K (1 + \cos\phi)` (harmonic), four terms of opls.

Source: A. Blondel, M. Karplus, J. Comput. Chem. 17, 1132 (1996), for the cross products.
"""
from __future__ import annotations

import math

from asemd.check.battery import Figure, case, vectors

DEGREES = (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
OPLS = (1.3, -0.7, 2.1, 0.4)
LINES = {"quadratic": "20.0 180.0", "harmonic": "20.0 1 1", "opls": " ".join(map(str, OPLS))}


def slope(style: str, delta: float) -> float:
    """dE/d phi at 180 degrees minus `delta` (radians)."""
    if style == "quadratic":
        return -40.0 * delta
    if style == "harmonic":
        return -20.0 * math.sin(delta)
    # sin(n phi) = -(-1)^n sin(n delta)
    return sum(0.5 * k * n * (1 if n % 2 == 0 else -1) * -(-1) ** n * math.sin(n * delta) for n, k in enumerate(OPLS, 1))


def chain(start, style: str, delta: float):
    session = start()
    session.commands_string(f"""
        units lj
        atom_style molecular
        atom_modify map array
        boundary f f f
        region box block -20 20 -20 20 -20 20
        create_box 1 box dihedral/types 1 extra/dihedral/per/atom 1
        mass 1 1.0
        create_atoms 1 single 0 1 0
        create_atoms 1 single 0 0 0
        create_atoms 1 single 1 0 0
        create_atoms 1 single 1 {-math.cos(delta)!r} {math.sin(delta)!r}
        pair_style zero 5.0
        pair_coeff * *
        dihedral_style {style}
        dihedral_coeff 1 {LINES[style]}
        create_bonds single/dihedral 1 1 2 3 4
        neighbor 1.0 bin
        fix 1 all nve
        run 0""")
    return session


@case("trans torsions",
      Figure("force 1 to 1e-6 degrees from trans, as angle", 2e-15, "error of the force of torsions (quadratic, harmonic, opls), given as "
             "the error of the angle (radians) that would have the same effect; a formula that goes through the cosine is off by 1e-8"))
def trans_torsions(start):
    worst = 0.0
    for style in LINES:
        for degrees in DEGREES:
            delta = math.radians(degrees)
            f = vectors(chain(start, style, delta), "f")[3]
            along = f[1] * math.sin(delta) + f[2] * math.cos(delta)       # the tangent, towards smaller phi
            worst = max(worst, delta * abs(along / slope(style, delta) - 1.0))
    return {"force 1 to 1e-6 degrees from trans, as angle": worst}
