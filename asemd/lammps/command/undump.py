"""``undump ID``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import exactly


def run(session, args):
    id = exactly(args, 1, "undump")[0]
    dumps = session.scene.dumps
    if id not in dumps:
        raise InputError(f"undump: there is no dump {id}{nearest(id, dumps)}")
    dumps.pop(id).close()
