r"""A quartic bond that is pulled apart and breaks at its longest extension, where neither force nor potential well is left.

The bond energy is :math:`K (r - R_c)^2 (r - R_c - B_1) (r - R_c - B_2) + U_0`, which at :math:`R_c` is :math:`U_0` without a force; there
the bond is taken away. So the kinetic energy does not jump, and the beads part with :math:`\tfrac{\mu}{2} v^2 = E - U_0`, to the error of
velocity Verlet, :math:`(\omega \Delta t)^2` = 1e-4 of the energy. The potential energy is the formula's before, to round-off, and nothing
after.

Source: M. J. Stevens, Macromolecules 34, 2710 (2001); LAMMPS manual, bond_style quartic.
"""
from __future__ import annotations

import math

from asemd.check.battery import Figure, case, vectors

K, B1, B2, RC, U0 = 1200.0, -0.55, 0.25, 1.3, 34.6878
REST = 0.97


def bonded(r: float) -> float:
    """Energy of the bond at that length, beyond the reach of the repulsion of the beads."""
    y = r - RC
    return K * y * y * (y - B1) * (y - B2) + U0


def dumbbell(start, speed: float, dt: float):
    session = start()
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary f f f
        region box block -30 30 -10 10 -10 10
        create_box 2 box bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 2
        mass * 1.0
        create_atoms 1 single {-0.6!r} 0 0
        create_atoms 2 single {0.6!r} 0 0
        pair_style lj/cut 1.122462048309373
        pair_coeff * * 1.0 1.0
        pair_modify shift yes
        bond_style quartic
        bond_coeff 1 {K} {B1} {B2} {RC} {U0}
        special_bonds lj 1 1 1
        create_bonds single/bond 1 1 2
        group left type 1
        group right type 2
        velocity left set {-speed!r} 0 0
        velocity right set {speed!r} 0 0
        neighbor 1.0 bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify norm no
        fix 1 all nve
        timestep {dt!r}
        run 0""")
    return session


@case("quartic breaking",
      Figure("kinetic energy of the parts", 1e-4, "how much energy the beads gained or lost until the bond had broken, relative to U0: "
             "they part with what they had beyond it"),
      Figure("energy of the bond, before and after", 1e-12, "how far the potential energies are from that of the bond and, after the "
             "break, from nothing, relative to U0"))
def quartic_breaking(start):
    energy = 1.2 * U0
    speed = math.sqrt(energy - bonded(1.2))
    session = dumbbell(start, speed, 1e-4)
    before = session.get_thermo("pe")
    session.command("run 10000")
    v, after = vectors(session, "v"), session.get_thermo("pe")
    kinetic = 0.25 * (v[1, 0] - v[0, 0]) ** 2
    return {"kinetic energy of the parts": abs(kinetic - (energy - U0)) / U0,
            "energy of the bond, before and after": (abs(before - bonded(1.2)) + abs(after)) / U0}
