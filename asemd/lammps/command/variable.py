"""``variable name style words...``"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import take


def run(session, args):
    take(args, 2, "variable")
    if args[1] == "delete" and len(args) > 2:
        raise InputError(f"variable {args[0]} delete takes no more words, got {' '.join(args[2:])}")
    session.variables.define(args[0], args[1], list(args[2:]))
