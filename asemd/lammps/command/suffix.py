"""``suffix off|on|style``: without effect; there is one implementation of each style."""
from __future__ import annotations

from asemd.words import take


def run(session, args):
    take(args, 1, "suffix")
    session.print("  suffix: no effect, asemd has one implementation of each style")
