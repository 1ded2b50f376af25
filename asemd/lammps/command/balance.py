"""``balance ...``: without effect, since atoms are not spread over processors."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import number, take

STYLES = ("x", "y", "z", "shift", "rcb")


def run(session, args):
    session.scene.need_system("balance")
    number(take(args, 2, "balance")[0], "balance: thresh")
    if args[1] not in STYLES:
        raise InputError(f"balance: unknown style {args[1]!r}{nearest(args[1], STYLES)}; there are {' '.join(STYLES)}")
    session.print("  balance: no effect, there is one process")
