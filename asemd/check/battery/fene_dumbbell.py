r"""Two beads on a FENE bond pulled apart by a force, up to 0.99 of the longest extension :math:`R_0`.

The bond pulls with :math:`F = K r / (1 - (r / R_0)^2)`, so under the force of the extension 0.99 the dumbbell stays at that extension,
where the bond is stiff but stable: the figure is round-off divided by 1 - r / R0, squared. A force that is clamped beyond 0.9487 of
:math:`R_0`, as LAMMPS's is, is weaker than the pull and the bond tears. Let go from 0.99 the dumbbell keeps its energy to the order of
the step squared: with :math:`\omega \Delta t` = 0.01 at the first point, the stiffest one, that is below :math:`\omega^2 \Delta t^2` =
1e-4.

Source: H. R. Warner, Ind. Eng. Chem. Fundam. 11, 379 (1972); K. Kremer, G. S. Grest, J. Chem. Phys. 92, 5057 (1990).
"""
from __future__ import annotations

import math

from asemd.check.battery import Figure, case, vectors

K, R0 = 30.0, 1.5
EXTENSIONS = (0.5, 0.9, 0.95, 0.97, 0.99)


def pull(extension: float) -> float:
    """Force of the bond at that fraction of its longest extension."""
    return K * extension * R0 / (1.0 - extension**2)


def dumbbell(start, extension: float, tension: float, dt: float, repulsion: str = "0.0 0.1"):
    session, half = start(), 0.5 * extension * R0
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary f f f
        region box block -50 50 -50 50 -50 50
        create_box 2 box bond/types 1 extra/bond/per/atom 1
        mass * 1.0
        create_atoms 1 single {-half!r} 0 0
        create_atoms 2 single {half!r} 0 0
        pair_style zero 5.0
        pair_coeff * *
        bond_style fene
        special_bonds lj 0 1 1
        bond_coeff 1 {K} {R0} {repulsion}
        create_bonds single/bond 1 1 2
        group left type 1
        group right type 2
        neighbor 1.0 bin
        neigh_modify delay 0 every 1 check yes
        fix 1 all nve
        fix 2 left addforce {-tension!r} 0 0
        fix 3 right addforce {tension!r} 0 0
        thermo_modify norm no
        timestep {dt!r}
        run 0""")
    return session


def length(session) -> float:
    x = vectors(session, "x")
    return abs(x[1, 0] - x[0, 0])


@case("FENE dumbbell",
      Figure("extension under tension, 0.5 to 0.99 R0", 1e-10, "how far 2000 steps under a steady pull move the bond from the extension at "
             "which force and pull are equal, in units of R0; infinite if the bond tears"),
      Figure("energy after release from 0.99 R0", 1e-4, "largest change of the energy of a dumbbell that was let go near its longest "
             "extension, relative to the energy of the bond; a clamped force loses energy here"))
def fene_dumbbell(start):
    worst = 0.0
    for extension in EXTENSIONS:
        stiffness = K * (1.0 + extension**2) / (1.0 - extension**2) ** 2
        dt = 0.05 / math.sqrt(2.0 * stiffness)
        session = dumbbell(start, extension, pull(extension), dt)
        for _ in range(20):
            try:
                session.command("run 100 pre no post no")
            except Exception:       # the bond tore; LAMMPS raises its own class
                worst = math.inf
                break
            worst = max(worst, abs(length(session) / R0 - extension))
    omega = math.sqrt(2.0 * K * (1.0 + 0.99**2)) / (1.0 - 0.99**2)
    session = dumbbell(start, 0.99, 0.0, 0.01 / omega, "1.0 1.0")
    first, change = session.get_thermo("etotal"), 0.0
    for _ in range(100):
        session.command("run 100 pre no")
        change = max(change, abs(session.get_thermo("etotal") - first))
    return {"extension under tension, 0.5 to 0.99 R0": worst, "energy after release from 0.99 R0": change / abs(first)}
