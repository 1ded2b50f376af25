"""``quit [status]``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps.session import Stop
from asemd.words import whole


def run(session, args):
    if len(args) > 1:
        raise InputError(f"quit takes an optional status, got {' '.join(args)}")
    raise Stop(whole(args[0], "quit") if args else 0)
