"""``unfix ID``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import exactly


def run(session, args):
    id = exactly(args, 1, "unfix")[0]
    fixes = session.scene.fixes
    if id not in fixes:
        raise InputError(f"unfix: there is no fix {id}{nearest(id, fixes)}")
    fix = fixes.pop(id)
    if session.scene.system is not None:
        fix.detach(session.scene.system)
    session.loop = None
