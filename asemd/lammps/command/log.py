"""``log file [append]``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import choice, take


def run(session, args):
    take(args, 1, "log")
    if len(args) > 2:
        raise InputError(f"log takes a file and perhaps append, got {' '.join(args)}")
    append = len(args) > 1 and choice(args[1], ("append",), "log") == "append"
    if not session.passive:
        session.log.open(args[0], append)
