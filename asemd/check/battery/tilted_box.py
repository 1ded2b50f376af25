r"""A box that is tilted beyond the limit at which it could be flipped, up to ten box lengths.

The edges :math:`b` and :math:`b + n a` span the same lattice, so energy, forces and pressure do not depend on n; the images of an atom in
one box are images in the other. The limit is round-off: positions some ten box lengths away have an error of 1e-15 of a box length.

Source: C. Kittel, Introduction to Solid State Physics, ch. 1, on the choice of cells.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, vectors

LENGTH, TURNS = 8.0, (1, 3, 10)
TILT = (0.2, -0.1, 0.3)     # xy xz yz in units of the length


def crystal(start, turns: int):
    """A warm crystal in a box whose tilts are larger by that many lengths; positions are brought into it."""
    rng = np.random.default_rng(4711)
    cell = LENGTH * np.array([[1.0, 0.0, 0.0], [TILT[0], 1.0, 0.0], [TILT[1], TILT[2], 1.0]])
    grid = np.stack(np.meshgrid(*3 * [np.arange(6) / 6.0], indexing="ij"), -1).reshape(-1, 3) + 1.0 / 12.0
    x = grid @ cell + rng.uniform(-0.1, 0.1, (216, 3))
    tilted = cell.copy()
    tilted[1, 0] += turns * LENGTH
    tilted[2, 1] += turns * LENGTH
    tilted[2, 0] += turns * cell[1, 0]
    fraction = x @ np.linalg.inv(tilted)
    x = (fraction - np.floor(fraction)) @ tilted
    xy, xz, yz = tilted[1, 0].item(), tilted[2, 0].item(), tilted[2, 1].item()
    session = start()
    session.commands_string(f"""
        units lj
        atom_modify map array
        boundary p p p
        box tilt large
        region box prism 0 {LENGTH} 0 {LENGTH} 0 {LENGTH} {xy!r} {xz!r} {yz!r}
        create_box 1 box
        mass 1 1.0
        pair_style lj/cut 2.5
        pair_coeff * * 1.0 1.0
        neighbor 0.3 bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify norm no
        fix 1 all nve
        timestep 0.002""")
    session.commands_string("\n".join(f"create_atoms 1 single {a:.17g} {b:.17g} {c:.17g}" for a, b, c in x))
    return session


@case("tilted box",
      Figure("energy and forces, 1 to 10 lengths", 1e-11, "largest relative difference of energy, forces and pressure to the same "
             "crystal in the box with small tilts"),
      Figure("energy over 200 steps", 1e-9, "largest relative difference of the potential energy to that box after 200 steps"))
def tilted_box(start):
    def look(turns):
        session = crystal(start, turns)
        if session.get_natoms() != 216:
            return math.inf, np.full((216, 3), math.inf), math.inf, math.inf
        session.command("run 0")
        first = session.get_thermo("pe"), vectors(session, "f"), session.get_thermo("press")
        session.command("run 200")
        return *first, session.get_thermo("pe")
    energy, forces, pressure, later = look(0)
    static, moving = 0.0, 0.0
    for turns in TURNS:
        e, f, p, after = look(turns)
        static = max(static, abs(e / energy - 1.0), abs(p / pressure - 1.0), float(abs(f - forces).max() / abs(forces).max()))
        moving = max(moving, abs(after / later - 1.0))
    return {"energy and forces, 1 to 10 lengths": static, "energy over 200 steps": moving}
