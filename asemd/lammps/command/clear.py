"""``clear``"""
from __future__ import annotations

from asemd.errors import InputError


def run(session, args):
    if args:
        raise InputError(f"clear takes no arguments, got {' '.join(args)}")
    session.clear()
