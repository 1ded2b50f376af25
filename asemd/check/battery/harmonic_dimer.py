r"""Two atoms on a spring, with steps from a tenth of what velocity Verlet stands to beyond it.

With :math:`h = \omega \Delta t` the elongations obey exactly :math:`q_{n+1} + q_{n-1} = (2 - h^2) q_n`: the frequency seen is
:math:`\tfrac{2}{\Delta t} \arcsin \tfrac h2`, the energy :math:`\tfrac{\mu}{2} v^2 + \tfrac{\mu}{2} \omega^2 (1 - \tfrac{h^2}{4}) q^2`
stays the same to the last digits, motion is bounded for h < 2 and grows for h > 2. The limits are round-off of a distance of 1 with
elongations of 0.001 over 200 steps, and the width of the bisection.

Source: E. Hairer, C. Lubich, G. Wanner, Acta Numerica 12, 399 (2003); B. Leimkuhler, C. Matthews, Molecular Dynamics (2015), ch. 2 and 3.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, onset, vectors

STIFFNESS = 100.0       # energy K (r - 1)^2: omega^2 = 2 K / mu = 4 K for masses of 1
OMEGA = math.sqrt(4.0 * STIFFNESS)
STEPS = (0.1, 0.5, 1.0, 1.5, 1.9, 1.99)


def dimer(start, h: float, q: float):
    """A session with the dimer stretched by `q`, one step ahead of its first run."""
    session = start()
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary f f f
        region box block -50 50 -50 50 -50 50
        create_box 1 box bond/types 1 extra/bond/per/atom 1
        mass 1 1.0
        create_atoms 1 single {-0.5 - 0.5 * q!r} 0 0
        create_atoms 1 single {0.5 + 0.5 * q!r} 0 0
        pair_style zero 5.0
        pair_coeff * *
        bond_style harmonic
        bond_coeff 1 {STIFFNESS} 1.0
        create_bonds single/bond 1 1 2
        neighbor 1.0 bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify lost ignore
        fix 1 all nve
        timestep {h / OMEGA!r}
        run 0""")
    return session


def stays(start, h: float) -> bool:
    """Whether 2000 steps keep the elongation within 100 times the first one."""
    session = dimer(start, h, 1e-5)
    try:
        session.command("run 2000 post no")
        x = vectors(session, "x")
        return bool(abs(abs(x[1, 0] - x[0, 0]) - 1.0) < 1e-3)
    except Exception:       # the dimer broke apart and its atoms are gone; LAMMPS raises its own class
        return False


@case("harmonic dimer",
      Figure("frequency shift, omega dt 0.1 to 1.99", 1e-8, "how far the frequency is from that of velocity Verlet in exact arithmetic, "
             "relative to it; any other integrator or force shows here"),
      Figure("shadow energy, omega dt 0.1 to 1.99", 1e-8, "largest relative change of the energy that velocity Verlet keeps exactly, over "
             "200 steps"),
      Figure("onset of instability, omega dt", 2e-3, "how far from omega dt = 2 the step is at which the motion stops being bounded"))
def harmonic_dimer(start):
    shift, change = 0.0, 0.0
    for h in STEPS:
        session = dimer(start, h, 1e-3)
        q, speed = [], []
        for _ in range(200):
            session.command("run 1 pre no post no")
            x, v = vectors(session, "x"), vectors(session, "v")
            q.append(x[1, 0] - x[0, 0] - 1.0)
            speed.append(v[1, 0] - v[0, 0])
        q, speed = np.array(q), np.array(speed)
        found = 2.0 - float(((q[2:] + q[:-2]) * q[1:-1]).sum() / (q[1:-1] ** 2).sum())
        shift = max(shift, abs(math.asin(min(math.sqrt(max(found, 0.0)) / 2.0, 1.0)) / math.asin(h / 2.0) - 1.0))
        energy = speed**2 + OMEGA**2 * (1.0 - h * h / 4.0) * q**2
        change = max(change, float(abs(energy / energy[0] - 1.0).max()))
    limit = onset(lambda h: stays(start, h), 1.9, 2.1, 2e-4)
    return {"frequency shift, omega dt 0.1 to 1.99": shift, "shadow energy, omega dt 0.1 to 1.99": change,
            "onset of instability, omega dt": abs(limit - 2.0)}
