"""``compute_modify ID keyword value ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take


def run(session, args):
    take(args, 2, "compute_modify")
    computes = session.scene.computes
    if args[0] not in computes:
        raise InputError(f"compute_modify: there is no compute {args[0]}{nearest(args[0], computes)}")
    computes[args[0]].modify(list(args[1:]), session)
