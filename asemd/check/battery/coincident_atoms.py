r"""Two atoms at exactly the same place.

Where the energy diverges at distance 0 (lj/cut) there is no force, and a program has to say so and name the atoms: the figure counts the
ones that go on in silence. Where the energy is finite (a soft repulsion, a spring) it has a value, :math:`2 A` and :math:`K r_0^2`, and
no direction: by symmetry the force is nothing. The limit is round-off.

Source: LAMMPS manual, pair_style soft, bond_style harmonic.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, vectors

SOFT, SPRING = 10.0, 25.0


def pair(start, more: str):
    session = start()
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary f f f
        region box block -10 10 -10 10 -10 10
        create_box 1 box bond/types 1 extra/bond/per/atom 1
        mass 1 1.0
        create_atoms 1 single 1 1 1
        create_atoms 1 single 2 1 1
        neighbor 1.0 bin
        thermo_modify norm no
        {more}
        set atom 2 x 1.0
        fix 1 all nve""")
    return session


def silent(start, more: str) -> int:
    """1 if a step with these atoms passes without an error that names them both, and gives numbers that are none."""
    session = pair(start, more)
    try:
        session.command("run 1")
    except Exception as e:      # LAMMPS raises its own class
        return 0 if {"1", "2"} <= set(str(e).replace(",", " ").split()) else 1
    return 0 if np.isfinite(vectors(session, "x")).all() and math.isfinite(session.get_thermo("pe")) else 1


@case("coincident atoms",
      Figure("divergent energies without a word", 0.0, "how many of two runs (lj/cut, lj96/cut) go on with numbers that are none; asemd "
             "stops and names both atoms"),
      Figure("finite energies", 1e-13, "error of the energy of a soft repulsion and of a spring at distance 0, and the force there, "
             "which is nothing"))
def coincident_atoms(start):
    count = sum(silent(start, f"pair_style {style} 2.5\npair_coeff * * 1.0 1.0") for style in ("lj/cut", "lj96/cut"))
    worst = 0.0
    for more, energy in ((f"pair_style soft 1.5\npair_coeff * * {SOFT}", 2.0 * SOFT),
                         (f"pair_style zero 2.5\npair_coeff * *\nbond_style harmonic\nspecial_bonds lj 1 1 1\nbond_coeff 1 {SPRING} 1.5\n"
                          "create_bonds single/bond 1 1 2", SPRING * 1.5**2)):
        session = pair(start, more)
        session.command("run 0")
        worst = max(worst, abs(session.get_thermo("pe") / energy - 1.0), float(abs(vectors(session, "f")).max()) / energy)
    return {"divergent energies without a word": count, "finite energies": worst}
