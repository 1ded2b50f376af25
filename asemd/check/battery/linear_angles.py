r"""Angles near 180 degrees, where the sine in the denominator of the textbook formula goes to zero although the force does not blow up.

With the middle atom a distance y beside the line of the other two, which are 1 away along it, the angle is :math:`180° - 2 \arctan y`,
and :math:`K (\theta - 180°)^2` pulls the middle atom back with :math:`8 K \arctan(y) / (1 + y^2)`. All coordinates are small numbers that
a computer holds to 16 digits, so what limits the force is that an angle near :math:`\pi` is a number with a rounding error of 2.2e-16 to
4.4e-16. The figure is the error of the force turned into the error of the angle that would cause it, relative error times angle; the
limit is 1e-15. A linear molecule bends with :math:`\omega^2 = \tfrac{2 K}{r^2} (\tfrac{2}{m} + \tfrac{4}{M})`, and velocity Verlet with
:math:`\sin(\omega' \Delta t / 2) = \omega \Delta t / 2`; the limit is the anharmonicity at 1e-4 radians, times a hundred.

Source: E. B. Wilson, J. C. Decius, P. C. Cross, Molecular Vibrations (1955).
"""
from __future__ import annotations

import math

from asemd.check.battery import Figure, case, steps, vectors

K, M_END, M_MIDDLE = 50.0, 1.0, 2.0
BENDS = (0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def molecule(start, y: float, bond: float = 0.0, dt: float = 0.005):
    session = start()
    session.commands_string(f"""
        units lj
        atom_style angle
        atom_modify map array
        boundary f f f
        region box block -20 20 -20 20 -20 20
        create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1
        mass 1 {M_END}
        mass 2 {M_MIDDLE}
        create_atoms 1 single -1 0 0
        create_atoms 2 single 0 {y!r} 0
        create_atoms 1 single 1 0 0
        pair_style zero 5.0
        pair_coeff * *
        bond_style harmonic
        bond_coeff 1 {bond!r} 1.0
        angle_style harmonic
        angle_coeff 1 {K} 180.0
        special_bonds lj 0 1 1
        create_bonds single/bond 1 1 2 special no
        create_bonds single/bond 1 2 3 special no
        create_bonds single/angle 1 1 2 3
        neighbor 1.0 bin
        fix 1 all nve
        timestep {dt!r}
        run 0""")
    return session


@case("linear angles",
      Figure("force 0.1 to 1e-8 from straight, as angle", 1e-15, "error of the force of an angle that is 0.1 to 1e-8 radians away from "
             "straight, and exactly straight, given as the error of the angle (radians) that would have the same effect"),
      Figure("bending frequency of a linear molecule", 1e-6, "relative error of the frequency at which a straight molecule swings through "
             "180 degrees by 1e-4 radians; a formula that caps 1 / sin makes the swing slower, or stops it"))
def linear_angles(start):
    worst = 0.0
    for y in BENDS:
        force = vectors(molecule(start, y), "f")[1, 1]
        bend = 2.0 * math.atan(y)
        worst = max(worst, abs(force * (1.0 + y * y) / (4.0 * K) + bend))
    omega2 = 2.0 * K * (2.0 / M_END + 4.0 / M_MIDDLE)
    dt = 0.2 / math.sqrt(omega2)
    x = steps(molecule(start, 1e-4, 100.0, dt), 200)[:, :, 1]
    bend = x[:, 1] - 0.5 * (x[:, 0] + x[:, 2])
    seen = 2.0 - float(((bend[2:] + bend[:-2]) * bend[1:-1]).sum() / (bend[1:-1] ** 2).sum())
    return {"force 0.1 to 1e-8 from straight, as angle": worst,
            "bending frequency of a linear molecule": abs(math.sqrt(max(seen, 0.0) / (omega2 * dt * dt)) - 1.0)}
