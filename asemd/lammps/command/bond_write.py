"""``bond_write btype N inner outer file keyword``: a bond potential as a section of a table file."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps.table_write import run_bonded
from asemd.words import number


def points(style, n, args):
    """N distances from inner to outer."""
    inner, outer = (number(w, "bond_write: inner and outer") for w in args[2:4])
    if not 0.0 < inner < outer:
        raise InputError(f"bond_write: inner must be above 0 and outer above inner, got {inner:g} {outer:g}")
    step = (outer - inner) / (n - 1)
    r = [inner + i * step for i in range(n)]
    return r, [[x] for x in r], [[1.0]] * n


def run(session, args):
    run_bonded(session, args, "bond", 6, points)
