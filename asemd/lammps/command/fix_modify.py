"""``fix_modify ID keyword value ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take


def run(session, args):
    take(args, 2, "fix_modify")
    fixes = session.scene.fixes
    if args[0] not in fixes:
        raise InputError(f"fix_modify: there is no fix {args[0]}{nearest(args[0], fixes)}")
    fixes[args[0]].modify(list(args[1:]), session)
