r"""Atoms that are a million periodic images away from where they began.

Half of a bonded liquid is moved by :math:`10^6` box lengths of 16. All coordinates are multiples of :math:`2^{-20}`, so
:math:`x + 10^6 L` has no more than 53 bits and is exact: energy and forces must stay the same to round-off, and position plus image times
length must give back where the atoms are. LAMMPS keeps image counts in ten bits each.

Source: D. Goldberg, ACM Computing Surveys 23, 5 (1991), for the arithmetic.
"""
from __future__ import annotations

import numpy as np

from asemd.check.battery import Figure, case, vectors

LENGTH, FAR = 16.0, 10**6


def liquid(start):
    rng = np.random.default_rng(4711)
    grid = np.stack(np.meshgrid(*3 * [np.arange(6.0)], indexing="ij"), -1).reshape(-1, 3) * 2.5 + 1.0
    x = np.round((grid + rng.uniform(-0.3, 0.3, grid.shape)) * 2.0**20) / 2.0**20
    atoms = [f"create_atoms {1 + k % 2} single {a!r} {b!r} {c!r}" for k, (a, b, c) in enumerate(x.tolist())]
    bonds = [f"create_bonds single/bond 1 {k} {k + 1} special no" for k in range(1, 216, 2)]
    session = start()
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary p p p
        region box block 0 {LENGTH} 0 {LENGTH} 0 {LENGTH}
        create_box 2 box bond/types 1 extra/bond/per/atom 1
        mass * 1.0
        pair_style lj/cut 4.0
        pair_coeff * * 1.0 2.0
        bond_style harmonic
        bond_coeff 1 20.0 2.0
        special_bonds lj 1 1 1
        neighbor 0.5 bin
        thermo_modify norm no""")
    session.commands_string("\n".join([*atoms, *bonds]))
    session.commands_string("group moved type 2\nfix 1 all nve\nrun 0")
    return session


@case("a million images away",
      Figure("energy and forces", 1e-13, "largest relative change of energy and forces when half of the atoms are moved by a million box "
             "lengths"),
      Figure("unwrapped positions, box lengths", 1e-9, "error of position plus image count times box length after the move; mean squared "
             "displacements are wrong by as much"))
def far_images(start):
    session = liquid(start)
    energy, forces, before = session.get_thermo("pe"), vectors(session, "f"), vectors(session, "x")
    before = before + LENGTH * vectors(session, "image")
    session.command(f"displace_atoms moved move {FAR * LENGTH!r} 0 0 units box")
    session.command("run 0")
    change = max(abs(session.get_thermo("pe") / energy - 1.0), float(abs(vectors(session, "f") - forces).max() / abs(forces).max()))
    places = vectors(session, "x") + LENGTH * vectors(session, "image")
    places[1::2, 0] -= FAR * LENGTH
    return {"energy and forces": change, "unwrapped positions, box lengths": float(abs(places - before).max()) / LENGTH}
