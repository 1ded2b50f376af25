r"""A Lennard-Jones melt at timesteps from 0.0025 to 0.03.

The forces go to zero smoothly (switched between 2 and 2.5), so the energy of velocity Verlet fluctuates as the timestep squared while it
is well below :math:`2 / \omega` of the collisions: the exponent between 0.0025 and 0.01 is 2, within 0.25 for runs of 2 time units. The
motion can be turned around: with the velocities reversed the same steps lead back, to round-off that grows tenfold per time unit or so in
a melt; 1e-9 after 100 steps. Up to 0.03, five times what is usual, the run either goes on with finite numbers or stops with a message.

Source: M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids (2017), ch. 3; L. Verlet, Phys. Rev. 159, 98 (1967).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, vectors

EQUILIBRATION, LENGTH = 0.004, 2.0


def melt(start, dt: float):
    """256 atoms that have melted from a crystal, one step ahead of the first run with that timestep."""
    session = start()
    session.commands_string(f"""
        units lj
        atom_style charge
        atom_modify map array
        boundary p p p
        lattice fcc 0.8442
        region box block 0 4 0 4 0 4
        create_box 1 box
        create_atoms 1 box
        mass 1 1.0
        pair_style lj/charmm/coul/charmm 2.0 2.5
        pair_coeff * * 1.0 1.0
        velocity all create 1.8 4711 loop geom
        neighbor 0.3 bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify norm no
        fix 1 all nve
        timestep {EQUILIBRATION}
        run 300 post no
        timestep {dt!r}""")
    return session


def fluctuation(start, dt: float) -> float:
    session, energies = melt(start, dt), []
    session.command("run 0 post no")
    for _ in range(100):
        session.command(f"run {max(1, round(LENGTH / dt / 100))} pre no post no")
        energies.append(session.get_thermo("etotal"))
    return float(np.std(energies))


def reversed_error(start) -> float:
    session = melt(start, 0.005)
    first = vectors(session, "x")
    session.command("run 100 post no")
    flip(session)
    session.command("run 100 post no")
    d, width = vectors(session, "x") - first, session.extract_box()[1][0]
    return float(abs(d - width * np.round(d / width)).max())


def flip(session) -> None:
    """Turn all velocities around."""
    from ctypes import POINTER, c_double
    v = np.ascontiguousarray(-vectors(session, "v"))
    session.scatter_atoms("v", 1, 3, v.ctypes.data_as(POINTER(c_double)))


def silent(start, dt: float) -> int:
    """1 if a run of 500 steps ends without a message with numbers that are none."""
    session = melt(start, dt)
    try:
        session.command("run 500 post no")
    except Exception:       # LAMMPS raises its own class
        return 0
    return 0 if np.isfinite(vectors(session, "x")).all() and math.isfinite(session.get_thermo("etotal")) else 1


@case("LJ melt",
      Figure("exponent of the energy error, 0.0025 to 0.01", 0.25, "how far the growth of the energy fluctuation with the timestep is from "
             "quadratic"),
      Figure("way back after 100 steps", 1e-9, "how far atoms end from where they began if all velocities are turned around after 100 "
             "steps, in atom diameters"),
      Figure("silent failures at 0.02 and 0.03", 0.0, "how many runs with far too long a timestep end with numbers that are none and "
             "without a message"))
def lj_melt(start):
    steps = (0.0025, 0.005, 0.01)
    exponent = np.polyfit(np.log(steps), np.log([fluctuation(start, dt) for dt in steps]), 1)[0]
    return {"exponent of the energy error, 0.0025 to 0.01": abs(exponent - 2.0), "way back after 100 steps": reversed_error(start),
            "silent failures at 0.02 and 0.03": sum(silent(start, dt) for dt in (0.02, 0.03))}
