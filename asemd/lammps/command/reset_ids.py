"""``reset_ids``: the older name of ``reset_atoms id``."""
from __future__ import annotations

from asemd.lammps.command import reset_atoms


def run(session, args):
    session.warn("'reset_ids' has been renamed to 'reset_atoms id'. Please update your input.")
    reset_atoms.run(session, ["id", *args])
