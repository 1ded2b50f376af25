"""``reset_mol_ids``: the older name of ``reset_atoms mol``."""
from __future__ import annotations

from asemd.lammps.command import reset_atoms


def run(session, args):
    session.warn("'reset_mol_ids' has been renamed to 'reset_atoms mol'. Please update your input.")
    reset_atoms.run(session, ["mol", *args])
