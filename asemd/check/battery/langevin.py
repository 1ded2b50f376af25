r"""Springs in a heat bath, with a friction that acts within a thousand steps or within a tenth of one.

Pairs of atoms on springs of rest length 0 are harmonic oscillators in each direction, with :math:`\omega \Delta t = h = 1`. The
temperature that their positions show, :math:`k \langle q^2 \rangle / k_B`, must be that of the bath for every
:math:`g = \gamma \Delta t`: the splitting BAOAB and the discretisation of Gronbech-Jensen and Farago (gjf) have it exactly at any stable
step, gjf vhalf that of the velocities too. The plain scheme of fix langevin with fix nve has :math:`1 / (1 - h^2 / (4 - 2 g))` times as
much, which follows from its linear map, and blows up for :math:`g / 2 + h^2 / 4 > 1`. Runs start with these temperatures; velocities at
the positions have :math:`1 - h^2 / 4` in the first two schemes and 1 in the plain one. The limits are four standard errors of 3000
oscillators seen once, :math:`4 \sqrt{2 / 3000}` = 0.103.

Source: B. Leimkuhler, C. Matthews, J. Chem. Phys. 138, 174102 (2013); N. Gronbech-Jensen, O. Farago, Mol. Phys. 111, 983 (2013); L. F. G.
Jensen, N. Gronbech-Jensen, Mol. Phys. 117, 2511 (2019).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, survives, vectors

K, H, TEMPERATURE, PAIRS = 0.25, 1.0, 1.0, 1000     # energy K q^2, reduced mass 1/2: omega = 1, so the timestep is H
DAMPINGS = (1e-3, 1e-2, 1e-1, 1.0, 10.0)
BOX = 40.0
LIMIT = 4.0 * math.sqrt(2.0 / (3 * PAIRS))


def springs(start, fixes: str, positions: float = 1.0, velocities: float = 1.0 - 0.25 * H * H):
    """A session with all pairs, whose positions and velocities have these temperatures in units of the bath's."""
    session, spread = start(), math.sqrt(3.0 * positions * TEMPERATURE / (2.0 * K))     # of a uniform distribution of that variance
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary p p p
        region box block 0 40 0 40 0 40 units box
        create_box 2 box bond/types 1 extra/bond/per/atom 1
        mass * 1.0
        pair_style zero 1.0
        pair_coeff * *
        comm_modify cutoff 9.0
        bond_style harmonic
        bond_coeff 1 {K} 0.0
        special_bonds lj 0 1 1
        lattice custom {4.0**-3!r} a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.5 0.5 0.5
        create_atoms 1 box
        lattice custom {4.0**-3!r} a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.502 0.5 0.5
        create_atoms 2 box
        group first type 1
        group second type 2
        neighbor 1.0 bin
        neigh_modify every 5 delay 5 check no
        create_bonds many first second 1 0.0 0.1
        pair_style none
        displace_atoms second random {spread!r} {spread!r} {spread!r} 4711 units box
        velocity all create {velocities * TEMPERATURE!r} 4712 mom no rot no dist gaussian loop geom
        timestep {H}
        {fixes}
        run 0 post no""")
    return session


def temperatures(session) -> tuple[float, float]:
    """Of positions and of velocities, in units of the bath's, over 1000 steps; not finite where the run blows up."""
    if not survives(session, "run 100 post no"):
        return math.inf, math.inf
    positions, velocities = [], []
    for _ in range(18):
        session.command("run 50 pre no post no")
        x, v = vectors(session, "x"), vectors(session, "v")
        q, u = x[PAIRS:] - x[:PAIRS], v[PAIRS:] - v[:PAIRS]
        q -= BOX * np.round(q / BOX)
        positions.append(2.0 * K * float((q * q).mean()))
        velocities.append(0.5 * float((u * u).mean()))
    return float(np.mean(positions)) / TEMPERATURE, float(np.mean(velocities)) / TEMPERATURE


def plain(g: float) -> float:
    """The temperature of positions of the plain scheme in units of the bath's; infinite where it blows up."""
    return 1.0 / (1.0 - H * H / (4.0 - 2.0 * g)) if g / 2.0 + H * H / 4.0 < 1.0 else math.inf


@case("Langevin",
      Figure("fix baoab: positions, gamma dt 1e-3 to 10", LIMIT, "how far the temperature of the positions is from that of the bath, for "
             "any friction; safe to use at large steps"),
      Figure("langevin gjf: positions, gamma dt 1e-3 to 10", LIMIT, "the same for fix langevin with the keyword gjf"),
      Figure("langevin gjf vhalf: velocities", LIMIT, "how far the temperature of the half-step velocities is from that of the bath"),
      Figure("plain langevin against its own theory", LIMIT, "how far fix langevin without gjf is from what theory says of it: positions "
             "1.3 to 2 times too warm at omega dt = 1, gone at gamma dt = 10; not a scheme for large steps"))
def langevin(start):
    gjf, half, known, baoab = [], [], [], []
    for g in DAMPINGS:
        damp = H / g
        positions, velocities = temperatures(springs(start, f"fix 1 all langevin 1 1 {damp!r} 4713 gjf vhalf\nfix 2 all nve"))
        gjf.append(abs(positions - 1.0))
        half.append(abs(velocities - 1.0))
        expected = plain(g)
        session = springs(start, f"fix 1 all langevin 1 1 {damp!r} 4713\nfix 2 all nve", expected if expected < math.inf else 1.0, 1.0)
        found = temperatures(session)[0]
        blown = found > 1e6
        known.append((0.0 if blown else math.inf) if math.isinf(expected) else abs(found / expected - 1.0))
        try:
            session = springs(start, f"fix 1 all baoab 1 1 {damp!r} 4713")
        except Exception:       # LAMMPS has no such fix, and raises its own class
            continue
        baoab.append(abs(temperatures(session)[0] - 1.0))
    figures = {"langevin gjf: positions, gamma dt 1e-3 to 10": max(gjf), "langevin gjf vhalf: velocities": max(half),
               "plain langevin against its own theory": max(known)}
    return figures | ({"fix baoab: positions, gamma dt 1e-3 to 10": max(baoab)} if len(baoab) == len(DAMPINGS) else {})
