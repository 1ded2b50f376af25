"""``dump_modify ID keyword values ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import take


def run(session, args):
    take(args, 2, "dump_modify")
    dumps = session.scene.dumps
    if args[0] not in dumps:
        raise InputError(f"dump_modify: there is no dump {args[0]}{nearest(args[0], dumps)}")
    dumps[args[0]].modify(list(args[1:]), session)
