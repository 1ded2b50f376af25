"""``unfix ID``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import exactly


def run(session, args):
    id = exactly(args, 1, "unfix")[0]
    fixes = session.scene.fixes
    if id not in fixes:
        raise InputError(f"unfix: there is no fix {id}{nearest(id, fixes)}")
    session.scene.remove_fix(id)
    session.loop = None
