"""``log file [append]``"""
from __future__ import annotations

from asemd.words import choice, take


def run(session, args):
    take(args, 1, "log")
    append = len(args) > 1 and choice(args[1], ("append",), "log") == "append"
    if not session.passive:
        session.log.open(args[0], append)
