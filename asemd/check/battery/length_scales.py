r"""The same liquid drop with all lengths a thousand times smaller and larger.

A power of two, :math:`2^{\pm 10}`, multiplies box, positions, velocities, sigma, cutoff, skin and timestep, so that the arithmetic is the
same digit by digit: energies stay, forces are divided by the scale, positions after 100 steps are multiplied by it. Absolute lengths in
the code (bins, skins, smallest distances) would show. The limit is the growth of round-off over 100 steps of a liquid.

Source: dimensional analysis.
"""
from __future__ import annotations

import numpy as np

from asemd.check.battery import Figure, case, vectors

SCALES = (2.0**-10, 2.0**10)


def drop(start, s: float):
    session = start()
    session.commands_string(f"""
        units lj
        atom_modify map array
        boundary p p p
        lattice custom {0.8 / s**3!r} a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.25 0.25 0.25
        region box block 0 6 0 6 0 6
        create_box 1 box
        create_atoms 1 box
        mass 1 1.0
        pair_style lj/cut {2.5 * s!r}
        pair_coeff * * 1.0 {s!r}
        neighbor {0.25 * s!r} bin
        neigh_modify delay 0 every 1 check yes
        thermo_modify norm no
        fix 1 all nve
        timestep {0.00390625 * s!r}""")
    rng = np.random.default_rng(4711)
    x, v = vectors(session, "x"), rng.integers(-1024, 1025, (216, 3)) / 1024.0
    push = rng.integers(-128, 129, (216, 3)) / 2048.0
    cell = session.extract_box()[1][0] / 6.0
    x = np.round((np.floor(x / cell) + 0.25) * (cell / s) * 4096.0) / 4096.0
    for name, values in (("x", (x + push) * s), ("v", v)):
        session.scatter_atoms(name, 1, 3, np.ascontiguousarray(values).ctypes.data_as(_doubles()))
    return session


def _doubles():
    from ctypes import POINTER, c_double
    return POINTER(c_double)


@case("length scales 1e-3 and 1e3",
      Figure("energy and forces", 1e-12, "largest relative difference to the same drop at scale 1, after the scale is taken out"),
      Figure("positions after 100 steps", 1e-10, "largest difference of a position, in units of the atom's diameter"))
def length_scales(start):
    def look(s):
        session = drop(start, s)
        session.command("run 0")
        first = session.get_thermo("pe"), vectors(session, "f") * s
        session.command("run 100")
        return *first, vectors(session, "x") / s, session.extract_box()[1][0] / s
    energy, forces, places, width = look(1.0)
    static, moving = 0.0, 0.0
    for s in SCALES:
        e, f, x, _ = look(s)
        d = x - places
        static = max(static, abs(e / energy - 1.0), float(abs(f - forces).max() / abs(forces).max()))
        moving = max(moving, float(abs(d - width * np.round(d / width)).max()))
    return {"energy and forces": static, "positions after 100 steps": moving}
