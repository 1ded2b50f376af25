"""``jump file|SELF [label]``"""
from __future__ import annotations

from asemd.lammps.session import Jump
from asemd.words import take


def run(session, args):
    take(args, 1, "jump")
    if session.exhausted:
        session.exhausted = False
        return
    raise Jump(args[0], args[1] if len(args) > 1 else None)
